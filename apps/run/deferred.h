// Subcommands that `carnot` leaves to programs beside it, so that the first geodesic need not wait
// until they are compiled.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the name is that of CLI11
class App;
}

namespace carnot::apps {

// Each has the subcommands of those before it, too.
enum class Program { kCarnot, kFamilies, kLaboratory };

struct DeferredCommand {
  const char* name;
  const char* description;
  Program program;
};

// Families of geodesics, and the laboratory: what measures carnot itself. scripts/run.sh knows the
// names, too.
inline constexpr std::array kDeferred = {
    DeferredCommand{"atlas", "Find the geodesics of many problems.", Program::kFamilies},
    DeferredCommand{"continue",
                    "Follow a geodesic while an end, the time or a parameter changes.",
                    Program::kFamilies},
    DeferredCommand{
        "front", "Fronts, spheres, caustics and cut loci of a point.", Program::kFamilies},
    DeferredCommand{"methods", "List the methods of integration.", Program::kLaboratory},
    DeferredCommand{
        "verify", "Measure what the methods keep, on a scene of every kind.", Program::kLaboratory},
    DeferredCommand{"paper", "Redo the figures and numbers of the paper.", Program::kLaboratory},
    DeferredCommand{"benchmark", "Measure speed against error.", Program::kLaboratory},
    DeferredCommand{"stress", "Find geodesics to many random targets.", Program::kLaboratory}};

// The name of the program's file, and of what CMake calls its target.
std::string program_name(Program program);

// Where this subcommand is; kCarnot also for what is none.
Program program_of(std::string_view command);

// The subcommand of this name, one of kDeferred, with its description.
CLI::App& add_deferred_command(CLI::App& app, std::string_view name);

// Becomes the program beside this one, with these arguments. Returns only where there is none:
// complains, and gives the exit status.
int become(Program program, const std::vector<std::string>& arguments);

}  // namespace carnot::apps
