// Many problems in arrays.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <limits>
#include <span>
#include <stdexcept>

#include "arrays.h"
#include "background.h"
#include "calls.h"
#include "carnot/shooting/solve_many.h"
#include "text/numbers.h"

namespace py = pybind11;

namespace carnot::python {
namespace {

using namespace apps;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// An array that threads without Python may read and let go of.
std::shared_ptr<const Array> shared(Array array) {
  return {new Array(std::move(array)), [](const Array* mine) {
            const py::gil_scoped_acquire lock;
            delete mine;
          }};
}

struct Question {
  std::shared_ptr<const Array> from;  // rows of n
  std::shared_ptr<const Array> to;
  std::shared_ptr<const Array> times;  // one for each, or one for all
  std::vector<bool> free_to;
  Dynamics dynamics;
  std::vector<Limit> limits;
  GeodesicOptions search;
  int threads = 0;

  [[nodiscard]] long count() const { return static_cast<long>(from->shape(0)); }
  [[nodiscard]] BoundaryValueProblem problem(long i) const {
    const int n = dynamics.dof;
    const double time = times->data()[times->size() == 1 ? 0 : i];
    BoundaryValueProblem one(
        dynamics, {from->data(i), from->data(i) + n}, {to->data(i), to->data(i) + n}, time);
    one.free_to = free_to;
    one.limits = limits;
    return one;
  }
};

// A column has `width` numbers for each of the `most` geodesics of a problem.
class Columns {
 public:
  Columns(long problems, int most, int n, long samples)
      : most_(most),
        n_(n),
        samples_(samples),
        found_(problems, 0),
        reason_(problems, name_of(Reason::kInterrupted)),
        message_(problems),
        missed_(problems, kNone),
        seconds_(problems, kNone) {
    for (auto* column : {&action_,
                         &length_,
                         &endpoint_error_,
                         &knot_defect_,
                         &label_,
                         &verification_,
                         &morse_index_,
                         &hits_}) {
      column->assign(problems * most, kNone);
    }
    p0_.assign(problems * most * n, kNone);
    to_.assign(problems * most * n, kNone);
    q_.assign(problems * most * samples * n, kNone);
  }

  void set(long i, const GeodesicReport& report) {
    found_[i] = static_cast<double>(report.geodesics.size());
    reason_[i] = name_of(report.reason);
    message_[i] = report.message;
    missed_[i] = report.missed_estimate.value_or(kNone);
    seconds_[i] = report.elapsed_seconds;
    for (std::size_t k = 0; k < report.geodesics.size(); ++k) {
      set(i * most_ + static_cast<long>(k), report.geodesics[k]);
    }
  }

  py::dict arrays() && {
    const auto rows = static_cast<py::ssize_t>(found_.size());
    const py::ssize_t most = most_;
    const py::ssize_t n = n_;
    py::dict arrays;
    const auto add = [&](const char* name, std::vector<double>& column) {
      arrays[name] = array_of(std::move(column), {rows, most});
    };
    add("action", action_);
    add("length", length_);
    add("endpoint_error", endpoint_error_);
    add("knot_defect", knot_defect_);
    add("label", label_);
    add("verification", verification_);
    add("morse_index", morse_index_);
    add("hits", hits_);
    arrays["p0"] = array_of(std::move(p0_), {rows, most, n});
    arrays["to"] = array_of(std::move(to_), {rows, most, n});
    if (samples_ > 0) {
      arrays["q"] = array_of(std::move(q_), {rows, most, py::ssize_t{samples_}, n});
    }
    arrays["found"] = array_of(std::move(found_));
    arrays["missed_estimate"] = array_of(std::move(missed_));
    arrays["seconds"] = array_of(std::move(seconds_));
    arrays["reason"] = py::cast(reason_);
    arrays["message"] = py::cast(message_);
    return arrays;
  }

 private:
  void set(long at, const Geodesic& geodesic) {
    action_[at] = geodesic.action;
    length_[at] = geodesic.length.value_or(kNone);
    const bool single = geodesic.verification == Verification::kSingle;
    const bool knots = geodesic.verification == Verification::kKnots;
    if (single) endpoint_error_[at] = geodesic.endpoint_error;
    if (knots) knot_defect_[at] = geodesic.knot_defect;
    label_[at] = static_cast<double>(geodesic.label);
    verification_[at] = static_cast<double>(geodesic.verification);
    if (geodesic.morse_index) morse_index_[at] = *geodesic.morse_index;
    hits_[at] = geodesic.hits;
    std::copy(geodesic.p0.begin(), geodesic.p0.end(), &p0_[at * n_]);
    std::copy(geodesic.to.begin(), geodesic.to.end(), &to_[at * n_]);
    for (long s = 0; s < samples_; ++s) {
      const std::vector<double>& q = geodesic.trajectory.q[s];
      std::copy(q.begin(), q.end(), &q_[(at * samples_ + s) * n_]);
    }
  }

  int most_;
  int n_;
  long samples_;
  std::vector<double> found_;
  std::vector<std::string> reason_;
  std::vector<std::string> message_;
  std::vector<double> missed_;
  std::vector<double> seconds_;
  std::vector<double> action_;
  std::vector<double> length_;
  std::vector<double> endpoint_error_;
  std::vector<double> knot_defect_;
  std::vector<double> label_;
  std::vector<double> verification_;
  std::vector<double> morse_index_;
  std::vector<double> hits_;
  std::vector<double> p0_;
  std::vector<double> to_;
  std::vector<double> q_;
};

long trajectory_samples(const Texts& options) {
  constexpr long kMost = 1000000;
  std::string text = "0";
  take(options, "trajectories", text);
  const long samples = parse_integer("--trajectories", text, 0, kMost);
  if (samples == 1) refuse("--trajectories", text, "has one end only", "0, or 2 or more");
  return samples;
}

std::shared_ptr<Question> question_of(const Model& model,
                                      const Texts& options,
                                      Array from,
                                      Array to,
                                      Array times,
                                      const std::vector<bool>& free_to) {
  const int n = model.entry().dof;
  check_rows(from, "starts", n);
  check_rows(to, "goals", n);
  if (from.shape(0) != to.shape(0)) {
    throw std::invalid_argument(
        fmt::format("goals: {} rows, but {} starts", to.shape(0), from.shape(0)));
  }
  if (times.size() != 1 && (times.ndim() != 1 || times.size() != from.shape(0))) {
    throw std::invalid_argument("time: neither one number nor one for each start");
  }
  const Run run = model.searching(options);
  auto question = std::make_shared<Question>();
  question->from = shared(std::move(from));
  question->to = shared(std::move(to));
  question->times = shared(std::move(times));
  question->free_to = free_to;
  question->dynamics = run.dynamics;
  question->limits = model.limits();
  question->search = check(model.search_options(options), run);
  question->search.samples = trajectory_samples(options);
  question->threads = run.threads;
  return question;
}

// Columns by name.
py::dict many(const ModelPointer& model,
              const Texts& options,
              const Array& from,
              const Array& to,
              const Array& times,
              const std::vector<bool>& free_to,
              const py::object& callback) {
  const auto question = question_of(*model, options, from, to, times, free_to);
  auto columns =
      answer_in_background<Columns>(callback, [model, question](const Progress& progress) {
        const Question& asked = *question;
        Columns answer(asked.count(), asked.search.count, asked.dynamics.dof, asked.search.samples);
        ManyOptions how;
        how.each = asked.search;
        how.threads = asked.threads;
        how.progress = progress;
        (void)solve_many({asked.count(), [&](long i) { return asked.problem(i); }},
                         how,
                         [&](long first, std::span<const GeodesicReport> reports) {
                           for (std::size_t i = 0; i < reports.size(); ++i) {
                             answer.set(first + static_cast<long>(i), reports[i]);
                           }
                           return true;
                         });
        return answer;
      });
  return std::move(columns).arrays();
}

}  // namespace

void add_many(ModelClass& model) {
  model.def("solve_many",
            many,
            py::arg("options"),
            py::arg("starts"),
            py::arg("goals"),
            py::arg("times"),
            py::arg("free_goal"),
            py::arg("progress"));
}

}  // namespace carnot::python
