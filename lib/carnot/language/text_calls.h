// The functions that the tables of a system from text point to.
#pragma once

#include "carnot/language/text_system.h"

namespace carnot::language {

// Fill the three tables of the system: functions, and then transcription and calls. All functions
// take a TextBound.
void connect_calls(TextSystem& system);
void connect_dynamics(TextSystem& system);

}  // namespace carnot::language
