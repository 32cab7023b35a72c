#include "background.h"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>

namespace py = pybind11;

namespace carnot::python {
namespace {

// All work that goes on, so that the interpreter can wait for it.
class Workshop {
 public:
  [[nodiscard]] bool closing() const { return closing_; }
  // False where nothing is begun any more.
  bool enter() {
    const std::lock_guard lock(mutex_);
    if (!closing_) ++at_work_;
    return !closing_;
  }
  void leave() {
    const std::lock_guard lock(mutex_);
    --at_work_;
    left_.notify_all();
  }
  void close() {
    std::unique_lock lock(mutex_);
    closing_ = true;
    left_.wait(lock, [&] { return at_work_ == 0; });
  }

 private:
  std::atomic<bool> closing_{false};
  std::mutex mutex_;
  std::condition_variable left_;
  int at_work_ = 0;
};

// Never destroyed: threads may still look at it when the process ends.
Workshop* the_workshop = new Workshop;

Workshop& workshop() { return *the_workshop; }

// The child of a fork has none of the threads that are at work in its parent.
[[maybe_unused]] const int kForks =
    pthread_atfork(nullptr, nullptr, [] { the_workshop = new Workshop; });

const std::thread::id kMainThread = std::this_thread::get_id();  // where carnot was imported

// What the two threads share.
struct Work {
  std::atomic<double> fraction{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false;
  std::exception_ptr error;
};

void run(Work& shared, const std::function<void(const Progress&)>& work) {
  std::exception_ptr error;
  try {
    work([&shared](double fraction) {
      shared.fraction = fraction;
      return !shared.stop && !workshop().closing();
    });
  } catch (...) {
    error = std::current_exception();
  }
  const std::lock_guard lock(shared.mutex);
  shared.error = error;
}

// False when it is still at work after a moment.
bool wait_without_lock(Work& shared) {
  constexpr std::chrono::milliseconds kMoment{10};
  std::unique_lock lock(shared.mutex);
  return shared.ended.wait_for(lock, kMoment, [&] { return shared.done; });
}

// The same without the interpreter's lock. A thread of Python that asks for the lock when the
// interpreter has ended is ended, too, which C++ does not survive: such a thread waits here until
// the process is gone. Only daemons are left then.
bool wait(Work& shared) {
  PyThreadState* const state = PyEval_SaveThread();
  const bool done = wait_without_lock(shared);
  const bool daemon = std::this_thread::get_id() != kMainThread;
  while (daemon && workshop().closing()) std::this_thread::sleep_for(std::chrono::seconds(1));
  PyEval_RestoreThread(state);
  return done;
}

// Asks the callback whether to go on: when there is news, and else ten times a second.
class Listener {
 public:
  explicit Listener(const py::object& callback) : callback_(callback) {}

  bool goes_on(double fraction) {
    constexpr int kPatience = 10;  // moments
    if (callback_.is_none() || (fraction == told_ && ++silent_ < kPatience)) return true;
    told_ = fraction;
    silent_ = 0;
    const py::object answer = callback_(fraction);
    return answer.is_none() || py::bool_(answer);
  }

 private:
  const py::object& callback_;
  double told_ = 0;
  int silent_ = 0;
};

}  // namespace

void run_in_background(const py::object& callback,
                       std::function<void(const Progress& progress)> work) {
  auto shared = std::make_shared<Work>();
  if (!workshop().enter()) throw std::runtime_error("the interpreter is ending");
  try {
    std::thread([shared, work = std::move(work)]() mutable {
      run(*shared, work);
      work = nullptr;  // with all that it owns
      {
        const std::lock_guard lock(shared->mutex);
        shared->done = true;
        shared->ended.notify_all();
      }
      workshop().leave();
    }).detach();
  } catch (const std::system_error& error) {
    workshop().leave();
    throw std::runtime_error(std::string("no thread could be started: ") + error.what());
  }
  Listener listener(callback);
  try {
    while (!wait(*shared)) {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (!listener.goes_on(shared->fraction)) shared->stop = true;
    }
  } catch (...) {
    shared->stop = true;
    throw;
  }
  if (shared->error) std::rethrow_exception(shared->error);
}

void finish_background() {
  const py::gil_scoped_release release;
  workshop().close();
}

}  // namespace carnot::python
