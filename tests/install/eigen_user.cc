// Another part of the program, which uses Eigen and knows nothing of carnot.
//
// Its functions on matrices are weak symbols of the same names as those that a library with Eigen
// inside would have. Compiled for another instruction set they align the heap differently, and the
// program would free what the others have allocated.
#include <Eigen/Dense>

double smallest_eigenvalue(int n);

double smallest_eigenvalue(int n) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(n, n);
  a.resize(n + 1, n + 1);
  a.setIdentity();
  Eigen::MatrixXd b = a / 2.0;
  b = a.inverse() * b;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(b);
  return solver.eigenvalues()[0];
}
