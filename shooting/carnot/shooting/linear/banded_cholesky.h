// Factors of a banded symmetric positive definite matrix: those of banded_ldlt.h with D > 0.
//
// Without pivots nothing leaves the band (Golub & Van Loan, Matrix Computations, 4.3.6).
#pragma once

#include "carnot/shooting/linear/banded_ldlt.h"

namespace carnot::internal {

class BandedCholesky : public BandedLdlt {
 public:
  using BandedLdlt::BandedLdlt;

  // Overwrites the matrix by its factors. False where it is not positive definite.
  [[nodiscard]] bool factor() { return BandedLdlt::factor() == 0; }
};

}  // namespace carnot::internal
