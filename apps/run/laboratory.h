// The laboratory: the subcommands that measure carnot itself. They are in a program of their own,
// carnot_laboratory, so that the first geodesic need not wait until they are compiled.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <string>
#include <vector>

namespace carnot::apps {

struct LaboratoryCommand {
  const char* name;
  const char* description;
};

// scripts/run.sh knows the names, too.
inline constexpr std::array kLaboratory = {
    LaboratoryCommand{"methods", "List the methods of integration."},
    LaboratoryCommand{"verify", "Measure what the methods keep, on a scene of every kind."},
    LaboratoryCommand{"paper", "Redo the figures and numbers of the paper."},
    LaboratoryCommand{"benchmark", "Measure speed against error."},
    LaboratoryCommand{"stress", "Find geodesics to many random targets."}};

bool is_laboratory_command(const std::string& name);

// The subcommand of this name, one of kLaboratory, with its description.
CLI::App& add_laboratory_command(CLI::App& app, const std::string& name);

// Becomes the carnot_laboratory beside this program, with these arguments. Returns only where there
// is none: complains, and gives the exit status.
int become_laboratory(const std::vector<std::string>& arguments);

}  // namespace carnot::apps
