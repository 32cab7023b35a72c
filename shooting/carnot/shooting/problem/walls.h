// The bounds of limits one by one: functions s(q) >= 0.
#pragma once

#include <vector>

#include "carnot/scene/limit.h"

namespace carnot::internal {

class Walls {
 public:
  // One wall: s = sign (value - bound).
  struct Wall {
    int limit = 0;
    double sign = 1;
    double bound = 0;
  };

  // Of configurations of n numbers. Keeps a reference to the limits.
  Walls(const std::vector<Limit>& limits, int n);

  [[nodiscard]] int size() const { return static_cast<int>(walls_.size()); }
  [[nodiscard]] const Wall& operator[](int i) const { return walls_[i]; }

  // At q: all s and, unless null, their gradients (size x n) and second derivatives (size x n x n).
  void evaluate(const double* q, double* s, double* gradients, double* hessians) const;

 private:
  const std::vector<Limit>& limits_;
  int n_;
  std::vector<Wall> walls_;
};

}  // namespace carnot::internal
