// Gnuplot as a process of its own, which Ctrl-C does not reach.
#pragma once

#include <string>

namespace carnot::plots {

// Runs gnuplot, without the user's own settings, in the `directory` and waits until it ends. It
// reads the file `script` of that directory, and all that it says goes to the file `log` there.
// Returns whether it ended well. Throws std::runtime_error when it cannot be started.
bool run_gnuplot(const std::string& directory, const std::string& script, const std::string& log);

}  // namespace carnot::plots
