// Axes of the fields that tests make.
#pragma once

#include "carnot/shooting/field.h"

namespace carnot::test {

inline FieldAxis axis(int coordinate, double first, double step, int count) {
  FieldAxis axis{coordinate, {}};
  for (int i = 0; i < count; ++i) axis.values.push_back(first + i * step);
  return axis;
}

}  // namespace carnot::test
