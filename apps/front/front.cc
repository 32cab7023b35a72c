// carnot front: how long extremals are shortest paths.
#include <memory>

#include "carnot/shooting/cut_time.h"
#include "front/front_request.h"
#include "front/front_result.h"
#include "run/subcommands.h"
#include "text/interrupt.h"
#include "text/output_file.h"

namespace carnot::apps {
namespace {

constexpr const char* kFrontFooter = R"(
--what cut --momentum P0: the time at which the extremal from Q0 with p(0) = P0 stops being a shortest
path, "cut_time"; its first conjugate time; and the momentum of another extremal that arrives at the
cut time at the same place, as long, "partner_p0". "label" tells which symmetry of the scene takes the
one to the other (mirror, reversal, mirror and reversal, or none); or conjugate, where neighbours
arrive; or none-found, where there is no cut up to --max-time. Scenes have velocity constraints or
driftless controls, and no potential. c P0 runs the same path c times as fast.

Examples
  carnot front unicycle --from 0,0,0 --momentum 0.4,0.3,0.9 --what cut
  carnot front heisenberg-group --from 0,0,0 --momentum 1,0,2 --what cut --json
  carnot front unicycle --from 0,0,0 --momentum 0.4,0.3,0.9 --what cut --cover --max-time 20

Exit status: 0 known, also where there is none up to --max-time; 1 it could not be told, or time was
up; 2 bad input, 130 interrupted.)";

void add_front_options(CLI::App& app, FrontCall& options) {
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    app.add_option(name, value, help)->type_name(type);
  };
  add("--from", options.from, "Q0", "configuration at the start, e.g. 0,0,0");
  add("--momentum", options.momentum, "P0", "momentum at the start, of one extremal");
  add("--what", options.what, "WHAT", "cut");
  add("--max-time", options.max_time, "T", "how far the extremal is followed (64 natural lengths)");
  add("--time-limit", options.time_limit, "SECONDS", "give up after so long (none)");
  app.add_flag("--mod-angles", options.mod_angles, "angles agree modulo their periods (so it is)");
  app.add_flag("--cover", options.cover, "angles that differ by a period are different places");
}

}  // namespace

void add_front(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<FrontCall>();
  options->run.searches = true;
  CLI::App& front =
      *app.add_subcommand("front", "How long extremals from a point are shortest paths.");
  add_front_options(front, *options);
  add_model_options(front, options->run);
  add_effort_options(front, options->run);
  add_table_options(front, options->run.destination);
  front.footer(kFrontFooter);
  front.callback([options, &invocation] {
    check_table_output(options->run.destination);
    const FrontRequest request = check(*options);
    CutTimeOptions cut;
    cut.max_time = request.max_time;
    cut.mod_angles = request.mod_angles;
    cut.seed = request.run.seed;
    cut.threads = request.run.threads;
    cut.time_limit = request.time_limit;
    cut.progress = [](double /*fraction*/) { return !interrupted(); };
    const CutTime found = cut_time(request.run.dynamics, request.from, request.momentum, cut);
    invocation.exit_status = found.status == CutStatus::kInterrupted
                                 ? kInterrupted
                                 : deliver(cut_time_result(request, found, invocation.arguments),
                                           request.run.destination);
  });
}

}  // namespace carnot::apps
