// The numbers of the variables in the graphs of this room.
//
// Formulas are read before it is known how many controls and multipliers there are, so each kind of
// variable has a block of its own with room for the most that are allowed.
#pragma once

#include <array>

namespace carnot::language {

inline constexpr int kMostCoordinates = 24;  // of a generalized Hamiltonian system, all of z
inline constexpr int kMostDof = 12;          // n: there are kernels for so many

struct Block {
  int first = 0;
  int count = 0;
};

inline constexpr Block kTime{0, 1};
inline constexpr Block kConfiguration{1, kMostCoordinates};
inline constexpr Block kMomentum{kConfiguration.first + kMostCoordinates, kMostCoordinates};
inline constexpr Block kVelocity{kMomentum.first + kMostCoordinates, kMostCoordinates};
inline constexpr Block kAlgebraic{kVelocity.first + kMostCoordinates, 2 * kMostCoordinates};
inline constexpr Block kMultiplier{kAlgebraic.first + kAlgebraic.count, kMostCoordinates};
inline constexpr int kVariables = kMultiplier.first + kMultiplier.count;

// The first `count` of a block.
constexpr Block first_of(const Block& block, int count) { return {block.first, count}; }

}  // namespace carnot::language
