#include "carnot/numerics/lu.h"

namespace carnot {

template bool lu_solve<double>(int size, double* a, int columns, double* b);

}  // namespace carnot
