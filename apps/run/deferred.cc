#include "run/deferred.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cassert>
#include <filesystem>
#include <system_error>

#include "run/delivery.h"

namespace carnot::apps {
namespace {

const DeferredCommand* find_deferred(std::string_view name) {
  const auto* const found =
      std::find_if(kDeferred.begin(), kDeferred.end(), [&](const DeferredCommand& one) {
        return one.name == name;
      });
  return found == kDeferred.end() ? nullptr : found;
}

}  // namespace

std::string program_name(Program program) {
  switch (program) {
    case Program::kFamilies:
      return "carnot_families";
    case Program::kLaboratory:
      return "carnot_laboratory";
    case Program::kCarnot:
      break;
  }
  return "carnot";
}

Program program_of(std::string_view command) {
  const DeferredCommand* const deferred = find_deferred(command);
  return deferred == nullptr ? Program::kCarnot : deferred->program;
}

CLI::App& add_deferred_command(CLI::App& app, std::string_view name) {
  const DeferredCommand* const command = find_deferred(name);
  assert(command != nullptr);
  return *app.add_subcommand(command->name, command->description);
}

int become(Program program, const std::vector<std::string>& arguments) {
  std::error_code error;
  // The program itself, wherever links to it are.
  const std::string target = program_name(program);
  const std::string file =
      std::filesystem::read_symlink("/proc/self/exe", error).replace_filename(target);
  std::vector<char*> words;
  words.push_back(const_cast<char*>(file.c_str()));
  for (const std::string& argument : arguments) {
    words.push_back(const_cast<char*>(argument.c_str()));
  }
  words.push_back(nullptr);
  execv(file.c_str(), words.data());
  complain(fmt::format("{} is a subcommand of {}, which cannot be run: build the target {}",
                       arguments.front(),
                       file,
                       target));
  return kNotDelivered;
}

}  // namespace carnot::apps
