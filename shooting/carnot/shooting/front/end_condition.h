// A condition on where extremals end.
#pragma once

namespace carnot {

// q_coordinate = q_equal + value, or q_coordinate = value where there is no second coordinate.
struct EndCondition {
  int coordinate = 0;
  int equal = -1;
  double value = 0;
};

}  // namespace carnot
