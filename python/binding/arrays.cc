#include "arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

namespace py = pybind11;

namespace carnot::python {
namespace {

void check_finite(const Array& array, const std::string& name) {
  const double* const begin = array.data();
  const double* const end = begin + array.size();
  const double* const bad = std::find_if(begin, end, [](double x) { return !std::isfinite(x); });
  if (bad != end) throw std::invalid_argument(fmt::format("{}: holds {}", name, *bad));
}

}  // namespace

py::array_t<double> array_of(std::vector<double>&& numbers, const std::vector<py::ssize_t>& shape) {
  auto own = std::make_unique<std::vector<double>>(std::move(numbers));
  double* const data = own->data();
  const py::capsule owner(own.get(),
                          [](void* memory) { delete static_cast<std::vector<double>*>(memory); });
  (void)own.release();
  return py::array_t<double>(shape, data, owner);
}

py::array_t<double> array_of(std::vector<double>&& numbers) {
  const auto size = static_cast<py::ssize_t>(numbers.size());
  return array_of(std::move(numbers), {size});
}

py::array_t<double> matrix_of(const std::vector<std::vector<double>>& rows, int columns) {
  py::array_t<double> matrix({static_cast<py::ssize_t>(rows.size()), py::ssize_t{columns}});
  double* to = matrix.mutable_data();
  for (const std::vector<double>& row : rows) to = std::copy(row.begin(), row.end(), to);
  return matrix;
}

std::vector<double> vector_of(const Array& array, const std::string& name, int n) {
  if (array.ndim() != 1 || array.shape(0) != n) {
    throw std::invalid_argument(fmt::format("{}: not {} numbers in a row", name, n));
  }
  check_finite(array, name);
  return {array.data(), array.data() + n};
}

void check_rows(const Array& array, const std::string& name, int n) {
  if (array.ndim() != 2 || array.shape(1) != n) {
    throw std::invalid_argument(fmt::format("{}: not rows of {} numbers", name, n));
  }
  check_finite(array, name);
}

}  // namespace carnot::python
