// The functions that the tables of a system from text point to.
#pragma once

#include "carnot/language/text_system.h"

namespace carnot::language {

// Fills the three tables of the system. The functions take a TextBound.
void connect_calls(TextSystem& system);

}  // namespace carnot::language
