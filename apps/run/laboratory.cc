#include "run/laboratory.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <system_error>

#include "run/delivery.h"

namespace carnot::apps {

bool is_laboratory_command(const std::string& name) {
  return std::any_of(kLaboratory.begin(), kLaboratory.end(), [&](const LaboratoryCommand& command) {
    return command.name == name;
  });
}

CLI::App& add_laboratory_command(CLI::App& app, const std::string& name) {
  const auto* const command =
      std::find_if(kLaboratory.begin(), kLaboratory.end(), [&](const LaboratoryCommand& one) {
        return one.name == name;
      });
  assert(command != kLaboratory.end());
  return *app.add_subcommand(command->name, command->description);
}

int become_laboratory(const std::vector<std::string>& arguments) {
  std::error_code error;
  // The program itself, wherever links to it are.
  const std::string program =
      std::filesystem::read_symlink("/proc/self/exe", error).replace_filename("carnot_laboratory");
  std::vector<char*> words;
  words.push_back(const_cast<char*>(program.c_str()));
  for (const std::string& argument : arguments) {
    words.push_back(const_cast<char*>(argument.c_str()));
  }
  words.push_back(nullptr);
  execv(program.c_str(), words.data());
  complain(
      fmt::format("{} is a subcommand of {}, which cannot be run: build the target "
                  "carnot_laboratory",
                  arguments.front(),
                  program));
  return kNotDelivered;
}

}  // namespace carnot::apps
