#include "program.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <stdexcept>

#include "carnot/language/nearest.h"
#include "carnot/language/text_error.h"
#include "run/deferred.h"
#include "run/delivery.h"
#include "run/subcommands.h"
#include "text/arguments.h"
#include "text/interrupt.h"
#include "text/launcher.h"
#include "text/numbers.h"
#include "text/version.h"

namespace carnot::apps {
namespace {

constexpr const char* kFooter = R"(
Examples
  carnot geodesic vehicle --from 0,0,0,0 --to 0,1,0,0 --plot parking.png
  carnot flow heisenberg --from 0,0,0 --momentum 0.1,0.3,1 --time 100 --tolerance 1e-10 --json
  carnot scenes vehicle
  carnot SUBCOMMAND --help

Results go to stdout, messages and the progress bar to stderr. Vectors are comma-separated in one
word, angles are radians: --from -3,4,-pi/2,0.

Exit status: 0 success, 1 the numerics did not deliver, 2 bad input, 130 interrupted.)";

std::vector<std::string> subcommand_names(CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands({})) names.push_back(sub->get_name());
  return names;
}

// All `--name`s of a subcommand.
std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

OptionNames classified_options(const CLI::App& app) {
  OptionNames names;
  for (const CLI::Option* option : app.get_options()) {
    const bool flag = option->get_items_expected_max() == 0;
    for (const std::string& name : option->get_lnames()) {
      const bool repeatable = name == "set" || name == "limit" || name == "disc" || name == "fix";
      auto& list = flag ? names.flags : repeatable ? names.repeatable : names.valued;
      list.push_back("--" + name);
    }
  }
  return names;
}

// The subcommand that runs; nullptr for --help and --version.
CLI::App* find_subcommand(CLI::App& app, const std::vector<std::string>& arguments) {
  const std::vector<std::string> names = subcommand_names(app);
  const std::string accepted = fmt::format("{} (see carnot --help)", fmt::join(names, ", "));
  if (arguments.empty()) refuse("SUBCOMMAND", "", "is missing", accepted);
  const std::string& first = arguments.front();
  if (first == "-h" || first == "--help" || first == "--version") return nullptr;
  if (std::find(names.begin(), names.end(), first) == names.end()) {
    refuse(
        "SUBCOMMAND", first, "no such subcommand" + language::suggestion(first, names), accepted);
  }
  return app.get_subcommand(first);
}

// What CLI11 could not place: the first of them, with the options there are.
[[noreturn]] void refuse_extras(const CLI::App& app, const CLI::App* subcommand) {
  const std::vector<std::string> extras = app.remaining(true);
  const std::string extra = extras.empty() ? "" : extras.front();
  if (subcommand == nullptr) refuse("argument", extra, "not expected", "see carnot --help");
  const std::vector<std::string> known = option_names(*subcommand);
  const bool option = extra.starts_with('-');
  const std::string name = extra.substr(0, extra.find('='));
  refuse(option ? "option" : "argument",
         extra,
         option ? "no such option" + language::suggestion(name, known) : "not expected",
         fmt::format("{}", fmt::join(known, ", ")));
}

void build(CLI::App& app, Invocation& invocation, std::span<const AddSubcommand> subcommands) {
  app.name("carnot");
  app.set_help_flag("-h,--help", "print this help and exit");
  app.set_version_flag(
      "--version", std::string("carnot ") + kVersion, "print the version and exit");
  app.footer(kFooter);
  for (const AddSubcommand add : subcommands) add(app, invocation);
  // For --help; what they do is in another program.
  const std::vector<std::string> names = subcommand_names(app);
  for (const DeferredCommand& command : kDeferred) {
    if (std::find(names.begin(), names.end(), command.name) != names.end()) continue;
    add_deferred_command(app, command.name);
  }
  app.require_subcommand(0, 1);
}

int run(const std::vector<std::string>& arguments, std::span<const AddSubcommand> subcommands) {
  Invocation invocation{arguments};
  CLI::App app("Geodesics of mechanical systems under velocity constraints.");
  build(app, invocation, subcommands);
  const CLI::App* subcommand = find_subcommand(app, arguments);
  std::vector<std::string> joined =
      subcommand == nullptr ? arguments : join_values(arguments, classified_options(*subcommand));
  std::reverse(joined.begin(), joined.end());  // as CLI11 wants them
  try {
    app.parse(joined);
  } catch (const CLI::ExtrasError&) {
    refuse_extras(app, subcommand);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help, --version
      app.exit(error);
      std::cout.flush();
      if (std::cout) return kSuccess;
      complain("cannot write to stdout");
      return kNotDelivered;
    }
    throw std::invalid_argument(error.what());
  }
  return invocation.exit_status;
}

}  // namespace

int run_program(const std::vector<std::string>& arguments,
                std::span<const AddSubcommand> subcommands) {
  int status = kNotDelivered;
  try {
    status = run(arguments, subcommands);
  } catch (const language::TextError& error) {
    // FILE:LINE:COLUMN, as editors read it, with the line and a caret below.
    if (speaks_for_all()) std::cerr << error.what() << '\n';
    return kBadInput;
  } catch (const std::invalid_argument& error) {
    if (speaks_for_all()) complain(error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    if (!interrupted()) complain(error.what());
  }
  if (!interrupted() || status == kSuccess) return status;
  if (speaks_for_all()) complain("interrupted");
  return kInterrupted;
}

int run_main(int argc, char** argv, Program self, std::span<const AddSubcommand> subcommands) {
  const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  if (!arguments.empty()) {
    const Program home = program_of(arguments.front());
    if (home > self) return become(home, arguments);
  }
  guard_streams();
  watch_for_interrupts();
  return run_program(arguments, subcommands);
}

}  // namespace carnot::apps
