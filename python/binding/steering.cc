// Steering for planners.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <span>
#include <stdexcept>

#include "arrays.h"
#include "background.h"
#include "calls.h"
#include "carnot/numerics/parallel.h"
#include "carnot/shooting/steering_function.h"
#include "text/numbers.h"

namespace py = pybind11;

namespace carnot::python {
namespace {

using namespace apps;

using Handle = std::shared_ptr<SteeringFunction>;

// What the search in this thread is told by the call that it is for.
thread_local const Progress* asking = nullptr;

struct Asking {
  explicit Asking(const Progress& progress) { asking = &progress; }
  ~Asking() { asking = nullptr; }
  Asking(const Asking&) = delete;
  Asking& operator=(const Asking&) = delete;
};

Handle make(const std::shared_ptr<Model>& model,
            const Texts& options,
            bool mod_angles,
            const std::vector<bool>& free_target) {
  if (!model->limits().empty()) {
    refuse("SCENE",
           model->entry().info.name,
           "steering does not keep to limits",
           "a scene without them");
  }
  const Run run = model->searching(options);
  const GeodesicOptions search = check(model->search_options(options), run);
  SteeringOptions steering;
  std::string time = "1";
  std::string memory = std::to_string(steering.memory);
  take(options, "time", time);
  take(options, "memory", memory);
  steering.time = parse_positive("--time", time);
  steering.mod_angles = mod_angles;
  steering.free_target = free_target;
  steering.starts = search.starts;
  steering.tolerance = search.absolute_tolerance.value_or(steering.tolerance);
  steering.seed = search.seed;
  steering.threads = std::max(1, run.threads);
  steering.memory = static_cast<std::size_t>(parse_integer("--memory", memory, 0, 1000000000));
  steering.goes_on = [] { return asking == nullptr || (*asking)(0); };
  return std::make_shared<SteeringFunction>(run.dynamics, steering);
}

// Ways of a question: {"found", "reason", "message", "distance", "q"} of each, with `samples` rows
// of q.
struct Way {
  Steering steering;
  std::vector<std::vector<double>> q;
};

Way sampled(const Steering& steering, int n, long samples, const Progress& progress) {
  constexpr long kOften = 1000;
  Way way{steering, {}};
  for (long i = 0; i < samples && steering.found(); ++i) {
    if (i % kOften == 0 && !progress(0)) break;
    way.q.emplace_back(n);
    (void)steering.at(static_cast<double>(i) / static_cast<double>(samples - 1), way.q.back());
  }
  return way;
}

py::list ways(
    const Handle& self, const Array& from_in, const Array& to_in, int count, long samples) {
  const int n = self->dof();
  const std::vector<double> from = vector_of(from_in, "start", n);
  const std::vector<double> to = vector_of(to_in, "goal", n);
  constexpr long kMostSamples = 1000000;
  if (samples < 2 || samples > kMostSamples) {
    throw std::invalid_argument(
        fmt::format("samples: {}; accepted: 2 to {}", samples, kMostSamples));
  }
  const auto found =
      answer_in_background<std::vector<Way>>(py::none(), [=](const Progress& progress) {
        std::vector<Way> list;
        const Asking call(progress);
        if (count == 1) {
          list.push_back(sampled(self->steer(from, to), n, samples, progress));
        } else {
          for (const Steering& way : self->alternatives(from, to, count)) {
            list.push_back(sampled(way, n, samples, progress));
          }
        }
        return list;
      });
  py::list list;
  for (const Way& way : found) {
    py::dict one;
    one["found"] = way.steering.found();
    one["reason"] = name_of(way.steering.reason());
    one["message"] = way.steering.message();
    one["distance"] = way.steering.distance();
    one["q"] = matrix_of(way.q, n);
    list.append(one);
  }
  return list;
}

// Of rows of starts and goals, on so many threads.
py::array_t<double> distances(const Handle& self,
                              const Array& from_in,
                              const Array& to_in,
                              int threads) {
  const int n = self->dof();
  check_rows(from_in, "starts", n);
  check_rows(to_in, "goals", n);
  if (from_in.shape(0) != to_in.shape(0)) {
    throw std::invalid_argument(
        fmt::format("goals: {} rows, but {} starts", to_in.shape(0), from_in.shape(0)));
  }
  const std::vector<double> from(from_in.data(), from_in.data() + from_in.size());
  const std::vector<double> to(to_in.data(), to_in.data() + to_in.size());
  const auto rows = static_cast<int>(from_in.shape(0));
  return array_of(
      answer_in_background<std::vector<double>>(py::none(), [=](const Progress& progress) {
        std::vector<double> list(rows);
        const auto row = [n](const std::vector<double>& of, int i) {
          return std::span(of).subspan(static_cast<std::size_t>(i) * n, n);
        };
        parallel_for(rows, thread_count(threads), [&](int i) {
          const Asking call(progress);
          if (progress(0)) list[i] = self->distance(row(from, i), row(to, i));
        });
        return list;
      }));
}

}  // namespace

void add_steering(py::module_& module) {
  py::class_<SteeringFunction, Handle>(module, "Steering")
      .def(py::init(&make),
           py::arg("model"),
           py::arg("options"),
           py::arg("mod_angles"),
           py::arg("free_goal"))
      .def_property_readonly("symmetric", &SteeringFunction::symmetric)
      .def("ways", ways, py::arg("start"), py::arg("goal"), py::arg("count"), py::arg("samples"))
      .def("distances", distances, py::arg("starts"), py::arg("goals"), py::arg("threads"));
}

}  // namespace carnot::python
