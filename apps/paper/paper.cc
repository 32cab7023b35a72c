// carnot paper: every figure and number of the paper's examples, beside what was found here.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "carnot/plots/interrupts_blocked.h"
#include "paper/paper_parts.h"
#include "run/deferred.h"
#include "run/delivery.h"
#include "run/subcommands.h"
#include "text/interrupt.h"
#include "text/numbers.h"
#include "text/output_file.h"
#include "text/progress_bar.h"

namespace carnot::apps {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPaperFooter = R"(
McLachlan, Modin, Verdier & Wilkins, Symplectic integrators for index one constraints, SIAM J. Sci.
Comput. 35 (2013), sections 5 and 6: what the paper says and what is measured here. A misprint is a
number that the paper's own equations contradict; the right one was measured.

Examples
  carnot paper
  carnot paper --output figures
  carnot paper --json

Exit status: 0 success, 1 a row fails or a file could not be written, 2 bad input, 130
interrupted.)";

struct PaperOptions {
  std::string output;
  Destination destination;
};

// Refuses unless `path` is, or can become, a directory to write in.
void check_directory(const std::string& path) {
  const std::string accepted = "a directory to write in, made where it is missing";
  std::error_code ignored;
  fs::path place = fs::absolute(path).lexically_normal();
  while (!fs::exists(place, ignored) && place.has_relative_path()) place = place.parent_path();
  if (!fs::is_directory(place, ignored)) {
    refuse("--output", path, fmt::format("'{}' is not a directory", place.string()), accepted);
  }
  if (access(place.c_str(), W_OK | X_OK) != 0) {
    const std::string why = fmt::format("no permission to write in '{}'", place.string());
    refuse("--output", path, why, accepted);
  }
}

// The figures are drawn in a directory of their own inside the target and then moved there all
// together, so that none appears when the work fails or is interrupted.
class Gallery {
 public:
  explicit Gallery(const std::string& path) : target_(fs::absolute(path).lexically_normal()) {
    std::error_code error;
    for (fs::path at = target_; !fs::exists(at, error) && at.has_relative_path();) {
      made_.push_back(at);
      at = at.parent_path();
    }
    fs::create_directories(target_, error);
    std::string name = (target_ / ".carnot-paper-XXXXXX").string();
    if (error || mkdtemp(name.data()) == nullptr) {
      remove_made();
      throw std::runtime_error(fmt::format("cannot write in directory '{}'", path));
    }
    workshop_ = name;
  }
  Gallery(const Gallery&) = delete;
  Gallery& operator=(const Gallery&) = delete;
  ~Gallery() {
    std::error_code ignored;
    fs::remove_all(workshop_, ignored);
    if (!finished_) remove_made();
  }

  [[nodiscard]] std::string place_of(const std::string& file) const {
    return (workshop_ / file).string();
  }

  void finish() {
    const plots::InterruptsBlocked blocked;
    for (const auto& entry : fs::directory_iterator(workshop_)) {
      std::error_code error;
      fs::rename(entry.path(), target_ / entry.path().filename(), error);
      if (error) {
        throw std::runtime_error(fmt::format("cannot write '{}': {}",
                                             (target_ / entry.path().filename()).string(),
                                             error.message()));
      }
      finished_ = true;
    }
  }

 private:
  // The directories that were not there before; only empty ones go.
  void remove_made() {
    std::error_code ignored;
    for (const fs::path& directory : made_) fs::remove(directory, ignored);
  }

  fs::path target_;
  fs::path workshop_;
  std::vector<fs::path> made_;  // innermost first
  bool finished_ = false;
};

std::vector<PaperPart> run_parts(bool quiet) {
  ProgressBar bar("steps", kPaperSteps, quiet);
  PaperWork work(bar.callback(), kPaperSteps);
  std::vector<PaperPart> parts{paper_sketch()};
  for (const auto& part :
       {paper_cosine, paper_straight, paper_circle, paper_returns, paper_heisenberg}) {
    parts.push_back(part(work));
  }
  return parts;
}

// All figures and paper.json. Returns warnings.
std::string write_gallery(const std::string& path,
                          const std::vector<PaperPart>& parts,
                          const std::string& json,
                          bool quiet) {
  std::vector<PaperFigure> figures;
  for (const PaperPart& part : parts) {
    figures.insert(figures.end(), part.figures.begin(), part.figures.end());
  }
  Gallery gallery(path);
  ProgressBar bar("figures", static_cast<double>(figures.size()), quiet);
  const Progress progress = bar.callback();
  std::string warnings;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    if (!progress(static_cast<double>(i) / static_cast<double>(figures.size()))) {
      throw std::runtime_error("stopped");
    }
    warnings += figures[i].draw(gallery.place_of(figures[i].name + ".png"));
  }
  write_file(gallery.place_of("paper.json"), json);
  if (interrupted()) throw std::runtime_error("stopped");
  gallery.finish();
  return warnings;
}

std::string figures_text(const std::vector<PaperPart>& parts, const std::string& directory) {
  std::string text;
  for (const PaperPart& part : parts) {
    for (const PaperFigure& figure : part.figures) {
      const fs::path file = fs::path(directory) / (figure.name + ".png");
      text += fmt::format("written  {}: {}\n", file.string(), figure.shows);
    }
  }
  return text + fmt::format("written  {}\n", (fs::path(directory) / "paper.json").string());
}

int run_paper(const PaperOptions& options, const std::vector<std::string>& arguments) {
  if (!options.output.empty()) check_directory(options.output);
  const auto clock = [] { return std::chrono::steady_clock::now(); };
  const auto begin = clock();
  std::vector<PaperPart> parts;
  Result result;
  try {
    parts = run_parts(options.destination.quiet);
  } catch (const std::runtime_error& error) {
    result.delivered = false;
    result.message = error.what();
  }
  const std::size_t failures = count_failures(parts);
  if (result.delivered && failures > 0) result.message = fmt::format("{} rows fail", failures);
  result.json = result_head(arguments);
  result.json["status"] = result.message.empty() ? "completed" : "failed";
  result.json["message"] = result.message;
  add_paper_json(parts, result.json);
  result.json["elapsed_seconds"] = std::chrono::duration<double>(clock() - begin).count();
  bool drawn = false;
  result.draw = [&](const std::string& directory) {
    std::string warnings =
        write_gallery(directory, parts, json_text(result.json), options.destination.quiet);
    drawn = true;
    return warnings;
  };
  result.text = [&] {
    return paper_text(parts) + (drawn ? figures_text(parts, options.output) : std::string());
  };
  Destination destination = options.destination;
  destination.plot = options.output;
  const int status = deliver(result, destination);
  if (status != kSuccess || failures == 0) return status;
  complain(result.message);
  return kNotDelivered;
}

}  // namespace

void add_paper(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<PaperOptions>();
  CLI::App& paper = add_deferred_command(app, "paper");
  paper.add_option("--output", options->output, "write figures and paper.json to a directory")
      ->type_name("DIR");
  paper.add_flag("--json", options->destination.json, "print one JSON object");
  paper.add_flag("--quiet", options->destination.quiet, "no progress bar");
  paper.footer(kPaperFooter);
  paper.callback([options, &invocation] {
    invocation.exit_status = run_paper(*options, invocation.arguments);
  });
}

}  // namespace carnot::apps
