// carnot front: surfaces that extremals from a point make, and how long one is a shortest path.
#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>

#include "carnot/shooting/cut_time.h"
#include "carnot/shooting/wavefront.h"
#include "front/front_request.h"
#include "front/front_result.h"
#include "run/deferred.h"
#include "run/subcommands.h"
#include "text/interrupt.h"

namespace carnot::apps {
namespace {

constexpr const char* kFrontFooter = R"(
--length R: the extremals from Q0 as a surface or, with two coordinates, as a curve. front: all of them,
at the length R. sphere: those that are shortest paths up to there, sewn along the cut locus; caustic:
their first conjugate points, or those of --order K, at lengths up to R; cut: where they stop being
shortest, at lengths up to R. For scenes with two or three admissible directions, and any with two
coordinates; where there are more than three coordinates, --fix momenta until a surface is left, and
see a section. A condition on the ends leaves one, too, of a front or of a sphere in four coordinates:
--fix theta=phi, or theta=0.5.
--cusps tells the cusp lines of a caustic, closed or open, its umbilics with their type, and
swallowtails. What is left out is said. Columns of a .csv: q_NAME..., p0_NAME..., t_cut, t_conj, length,
label; p0 is of speed 1.

--what cut --momentum P0: the time at which the extremal from Q0 with p(0) = P0 stops being a shortest
path, "cut_time"; its first conjugate time; and the momentum of another extremal that arrives at the
cut time at the same place, as long, "partner_p0". "label" tells which symmetry of the scene takes the
one to the other (mirror, reversal, mirror and reversal, or none); or conjugate, where neighbours
arrive; or none-found, where there is no cut up to --max-time. Scenes have velocity constraints or
driftless controls, and no potential. c P0 runs the same path c times as fast.

Examples
  carnot front unicycle --from 0,0,0 --what sphere --length 2 --check --output sphere.vtp
  carnot front heisenberg-group --from 0,0,0 --what front --length 0.5,1 --output front.ply
  carnot front engel --from 0,0,0,0 --what front --length 1 --fix p_x4=0 --output engel.vtp
  carnot front vehicle --from 0,0,0,0 --what front --length 1 --fix theta=phi --plot vehicle.png
  carnot front vehicle --from 0,0,0,0 --what sphere --length 1 --fix theta=phi --check --plot ball.png
  carnot front grushin --from 0,0 --what sphere --length 1,2 --check --plot spheres.png
  carnot front unicycle --from 0,0,0 --what caustic --length 8 --order 2 --plot second.png
  carnot front unicycle --from 0,0,0 --momentum 0.4,0.3,0.9 --what cut
  carnot front heisenberg-group --from 0,0,0 --momentum 1,0,2 --what cut --json
  carnot front unicycle --from 0,0,0 --momentum 0.4,0.3,0.9 --what cut --cover --max-time 20
  carnot front satellite-quaternion --from 1,0,0,0 --momentum 0,1,0,0.2 --what cut --mod-sign w,x,y,z

Exit status: 0 known, also where there is none up to --max-time; 1 it could not be told, or time was
up; 2 bad input, 130 interrupted.)";

int run_cut_time(const FrontRequest& request, const std::vector<std::string>& arguments) {
  CutTimeOptions options;
  options.max_time = request.max_time;
  options.mod_angles = request.mod_angles;
  options.signs = request.front.signs;
  options.seed = request.run.seed;
  options.threads = request.run.threads;
  options.time_limit = request.time_limit;
  options.progress = [](double /*fraction*/) { return !interrupted(); };
  const CutTime cut = cut_time(request.run.dynamics, request.from, request.momentum, options);
  if (cut.status == CutStatus::kInterrupted) return kInterrupted;
  return deliver(cut_time_result(request, cut, arguments), request.run.destination);
}

int run_surfaces(const FrontRequest& request, const std::vector<std::string>& arguments) {
  std::vector<FrontMesh> meshes;
  FrontOptions options = request.front;
  const auto began = std::chrono::steady_clock::now();
  options.progress = [&](double /*fraction*/) {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - began;
    return !interrupted() && passed.count() < request.time_limit;
  };
  for (const double length : request.lengths) {
    options.length = length;
    meshes.push_back(wavefront(request.run.dynamics, request.from, options));
    if (interrupted()) return kInterrupted;
    if (!meshes.back().finished) break;
  }
  Destination destination = request.run.destination;
  destination.output = request.output;
  return deliver(surfaces_result(request, meshes, arguments), destination);
}

void add_front_options(CLI::App& app, FrontCall& options) {
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    app.add_option(name, value, help)->type_name(type);
  };
  add("--from", options.from, "Q0", "configuration at the start, e.g. 0,0,0");
  add("--momentum", options.momentum, "P0", "momentum at the start, of one extremal");
  add("--what", options.what, "WHAT", "front, sphere, caustic or cut");
  add("--length", options.length, "R[,R...]", "of surfaces: lengths of the extremals");
  add("--max-time", options.max_time, "T", "how far the extremal is followed (64 natural lengths)");
  add("--time-limit", options.time_limit, "SECONDS", "give up after so long (none)");
  app.add_option(
         "--fix",
         options.fix,
         "fix a momentum, where there are more than three (repeatable), or where a front ends")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  add("--project", options.project, "X,Y,Z", "the coordinates that are seen (the first three)");
  add("--order", options.order, "K", "of a caustic: the K-th conjugate points (1)");
  add("--edge", options.edge, "E", "longest edge, in widths of the surface (0.1)");
  add("--vertices", options.vertices, "N", "at most so many (100000)");
  add("--bound", options.bound, "W", "how far along the line of momenta (chosen)");
  add("--output",
      options.output,
      "FILE",
      "write surfaces as .vtp, .ply or .csv; a cut time as .json");
  add("--plot",
      options.run.destination.plot,
      "FILE",
      "draw surfaces: .png, .svg, .pdf or .gif, which grows with R");
  app.add_flag("--times", options.times, "cut and conjugate times at all vertices, of fronts, too");
  app.add_flag("--cusps", options.cusps, "cusp lines, umbilics and swallowtails of a caustic");
  app.add_flag("--check", options.check, "of a sphere: closed, Euler characteristic, volume");
  app.add_flag("--json", options.run.destination.json, "print one JSON object");
  app.add_flag("--quiet", options.run.destination.quiet, "no progress bar");
  app.add_flag("--mod-angles", options.mod_angles, "angles agree modulo their periods (so it is)");
  add("--mod-sign",
      options.mod_sign,
      "NAME,...",
      "q and -q are one place, as w,x,y,z of rotations");
  app.add_flag("--cover", options.cover, "angles that differ by a period are different places");
}

}  // namespace

void add_front(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<FrontCall>();
  options->run.searches = true;
  CLI::App& front = add_deferred_command(app, "front");
  add_front_options(front, *options);
  add_model_options(front, options->run);
  add_effort_options(front, options->run);
  front.footer(kFrontFooter);
  front.callback([options, &invocation] {
    const FrontRequest request = check(*options);
    invocation.exit_status = request.momentum.empty() ? run_surfaces(request, invocation.arguments)
                                                      : run_cut_time(request, invocation.arguments);
  });
}

}  // namespace carnot::apps
