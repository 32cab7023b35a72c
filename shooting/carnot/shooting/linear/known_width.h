// Lengths of rows that the compiler knows, so that it unrolls what goes along a row.
#pragma once

#include <type_traits>

namespace carnot::internal {

// run(std::integral_constant of `width`) where it is one of these, of 0 where it is another.
template <int first, int... others, class Run>
auto with_known_width(int width, const Run& run) {
  if (width == first) return run(std::integral_constant<int, first>{});
  if constexpr (sizeof...(others) > 0) {
    return with_known_width<others...>(width, run);
  } else {
    return run(std::integral_constant<int, 0>{});
  }
}

}  // namespace carnot::internal
