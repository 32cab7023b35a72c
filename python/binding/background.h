// Long work in the background, so that Python stays awake: Ctrl-C, progress, other threads.
//
// The work runs in a thread of its own and never touches Python. The calling thread waits without
// the interpreter's lock, and wakes a hundred times a second to look for signals and to tell a
// callback how far the work is. After an interrupt the caller goes on at once; the work is told to
// stop, ends by itself a moment later, and what it found is dropped. When the interpreter ends, all
// work is told to stop, and waited for.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "carnot/flow/reports.h"

namespace carnot::python {

// Runs the work and waits for it. `callback` is None or called with the fraction done; where it
// returns False the work is told to stop, and waited for. What the work or the callback throws is
// thrown. The work must own all that it uses: it may outlive the call, and the scene that was
// asked. std::runtime_error where no thread can be started, or the interpreter is ending.
void run_in_background(const pybind11::object& callback,
                       std::function<void(const Progress& progress)> work);

// Stops all work and waits for it: to be called before the interpreter ends.
void finish_background();

// The same for work with an answer.
template <class Answer>
Answer answer_in_background(const pybind11::object& callback,
                            std::function<Answer(const Progress& progress)> work) {
  auto answer = std::make_shared<std::optional<Answer>>();
  run_in_background(callback, [answer, work = std::move(work)](const Progress& progress) {
    *answer = work(progress);
  });
  return std::move(**answer);
}

}  // namespace carnot::python
