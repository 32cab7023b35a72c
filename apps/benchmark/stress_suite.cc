#include "benchmark/stress_suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "text/progress_bar.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

// A group, and its share of the time.
struct Group {
  std::vector<StressCase> (*cases)(const SuiteOptions&, const Progress&);
  double share;
};

constexpr Group kGroups[] = {{unstable_cases, 0.01},
                             {long_cases, 0.8},
                             {stiff_cases, 0.02},
                             {index_cases, 0.01},
                             {boundary_cases, 0.16}};

}  // namespace

std::optional<std::vector<StressCase>> run_suite(const SuiteOptions& options,
                                                 const Progress& progress) {
  std::vector<StressCase> all;
  double begin = 0;
  for (const Group& group : kGroups) {
    std::vector<StressCase> cases = group.cases(options, part_of(progress, begin, group.share));
    if (cases.empty()) return std::nullopt;
    std::move(cases.begin(), cases.end(), std::back_inserter(all));
    begin += group.share;
  }
  return all;
}

Json suite_json(const std::vector<StressCase>& cases) {
  Json rows = Json::array();
  long held = 0;
  for (const StressCase& one : cases) {
    held += one.holds() ? 1 : 0;
    rows.push_back({{"group", one.group},
                    {"case", one.name},
                    {"law", one.law},
                    {"figure", one.figure},
                    {"bound", one.bound},
                    {"holds", one.holds()},
                    {"naive", one.naive},
                    {"naive_figure", one.naive_figure}});
  }
  return {{"cases", rows}, {"count", cases.size()}, {"held", held}};
}

std::string suite_text(const std::vector<StressCase>& cases) {
  std::string text;
  long held = 0;
  for (auto first = cases.begin(); first != cases.end();) {
    std::vector<std::vector<std::string>> rows{
        {"case", "law", "off by", "allowed", "naive method", ""}};
    auto one = first;
    for (; one != cases.end() && one->group == first->group; ++one) {
      rows.push_back({one->name,
                      one->law,
                      text_number(one->figure, 2) + (one->holds() ? "" : "*"),
                      text_number(one->bound, 2),
                      one->naive,
                      text_number(one->naive_figure, 2)});
      held += one->holds() ? 1 : 0;
    }
    text += fmt::format("{}\n{}\n", first->group, text_table(rows));
    first = one;
  }
  return text + fmt::format("{} of {} hold\n", held, cases.size());
}

}  // namespace carnot::apps
