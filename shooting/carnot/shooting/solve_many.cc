#include "carnot/shooting/solve_many.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>

#include "carnot/numerics/parallel.h"

namespace carnot {
namespace {

// What the threads share.
class Crew {
 public:
  Crew(const ManyProblems& problems, const ManyOptions& options, const ReportSink& sink)
      : problems_(problems),
        options_(options),
        sink_(sink),
        chunks_((problems.count + options.chunk - 1) / options.chunk),
        each_(options.each) {
    each_.threads = 1;
    each_.progress = [this](double) { return go_on(); };
  }

  [[nodiscard]] long chunks() const { return chunks_; }
  // What is thrown ends all of it.
  void work() {
    try {
      for (long k = next(); k >= 0 && !stopped_; k = next()) solve(k);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      stopped_ = true;
    }
  }
  // Whether all is done.
  [[nodiscard]] bool finish() const {
    if (error_) std::rethrow_exception(error_);
    return !stopped_;
  }

 private:
  long next() {
    if (options_.next) return options_.next();
    const long k = next_++;
    return k < chunks_ ? k : -1;
  }

  bool go_on() {
    if (!stopped_ && options_.progress) {
      const double fraction = static_cast<double>(done_) / static_cast<double>(chunks_);
      if (!options_.progress(fraction)) stopped_ = true;
    }
    return !stopped_;
  }

  GeodesicReport solve_one(long i) const {
    try {
      return find_geodesics(problems_.at(i), each_);
    } catch (const std::invalid_argument& error) {
      GeodesicReport report;
      report.reason = Reason::kIrregularEnd;
      report.message = error.what();
      return report;
    }
  }

  void solve(long k) {
    const long first = k * options_.chunk;
    const long last = std::min(first + options_.chunk, problems_.count);
    std::vector<GeodesicReport> reports;
    for (long i = first; i < last; ++i) {
      if (!go_on()) return;
      reports.push_back(solve_one(i));
      if (stopped_) return;  // what was interrupted is no answer
    }
    const std::lock_guard lock(sink_mutex_);
    if (stopped_) return;
    if (!sink_(first, reports)) stopped_ = true;
    ++done_;
  }

  const ManyProblems& problems_;
  const ManyOptions& options_;
  const ReportSink& sink_;
  const long chunks_;
  GeodesicOptions each_;
  std::atomic<long> next_{0};
  std::atomic<long> done_{0};
  std::atomic<bool> stopped_{false};
  std::mutex sink_mutex_;
  std::mutex mutex_;  // of the error
  std::exception_ptr error_;
};

}  // namespace

bool solve_many(const ManyProblems& problems, const ManyOptions& options, const ReportSink& sink) {
  if (problems.count < 0 || options.chunk < 1 || options.threads < 0) {
    throw std::invalid_argument(
        "count, chunk or threads is " +
        std::to_string(
            std::min({problems.count, options.chunk, static_cast<long>(options.threads)})) +
        ", must not be negative, and chunk must be >= 1");
  }
  Crew crew(problems, options, sink);
  const int threads =
      static_cast<int>(std::min(crew.chunks(), static_cast<long>(thread_count(options.threads))));
  parallel_for(threads, threads, [&](int) { crew.work(); });
  return crew.finish();
}

}  // namespace carnot
