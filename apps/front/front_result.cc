#include "front/front_result.h"

#include <fmt/format.h>

#include <utility>

#include "text/text_table.h"

namespace carnot::apps {
namespace {

Json cut_time_json(const FrontRequest& request,
                   const CutTime& cut,
                   const std::vector<std::string>& arguments) {
  Json json = result_head(arguments);
  json["scene"] = request.run.entry->info.name;
  json["parameters"] = parameters_json(request.run);
  json["from"] = request.from;
  json["momentum"] = request.momentum;
  json["method"] = request.run.method.name;
  json["status"] = cut.status == CutStatus::kConverged ? "converged" : "not_converged";
  json["message"] = cut.message;
  json["cut_time"] = or_null(cut.cut_time);
  json["conjugate_time"] = or_null(cut.conjugate_time);
  json["partner_p0"] = or_null(cut.partner_p0);
  json["label"] = cut.label;
  json["max_time"] = cut.max_time;
  json["searches"] = cut.searches;
  json["elapsed_seconds"] = cut.elapsed_seconds;
  return json;
}

std::string cut_time_text(const FrontRequest& request, const CutTime& cut) {
  constexpr int kDigits = 15;
  const std::string none = fmt::format("none up to {:g}", cut.max_time);
  const auto time = [&](const std::optional<double>& t) {
    return t ? text_number(*t, kDigits) : none;
  };
  std::vector<std::vector<std::string>> rows{{"cut time", time(cut.cut_time)},
                                             {"conjugate time", time(cut.conjugate_time)}};
  if (cut.partner_p0) rows.push_back({"partner's p0", text_vector(*cut.partner_p0, kDigits)});
  rows.push_back({"label", cut.label});
  rows.push_back({"seconds", text_number(cut.elapsed_seconds, 3)});
  return fmt::format("{}: how long p0 = {} is the shortest way\n\n",
                     request.run.entry->info.name,
                     text_vector(request.momentum, kDigits)) +
         text_table(rows);
}

}  // namespace

Result cut_time_result(const FrontRequest& request,
                       const CutTime& cut,
                       const std::vector<std::string>& arguments) {
  Result result;
  result.delivered = cut.status == CutStatus::kConverged;
  result.message = "the cut time is not known: " + cut.message;
  result.json = cut_time_json(request, cut, arguments);
  result.text = [&] { return cut_time_text(request, cut); };
  return result;
}

}  // namespace carnot::apps
