// Ctrl-C and SIGTERM: the first asks the work to stop, a later one ends the process.
//
// Later means half a second: timeout(1) sends its signal to the process and at once to its group.
// Work polls interrupted() in its progress callback and returns; main then exits with 130. While a
// file is being written the signals wait (plots/interrupts_blocked.h), so that no half of it stays
// behind.
#pragma once

namespace carnot::apps {

void watch_for_interrupts();

// A file that may grow no further is an error of writing, not the end of the program; and what was
// closed from outside as stdin, stdout or stderr is not opened again as a file of ours.
void guard_streams();
[[nodiscard]] bool interrupted();

}  // namespace carnot::apps
