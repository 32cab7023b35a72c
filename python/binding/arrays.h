// Numbers between numpy and the library.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

namespace carnot::python {

// Contiguous rows of doubles. What else numpy can turn into them is copied.
using Array = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

// An array that owns the numbers: they are moved, not copied.
pybind11::array_t<double> array_of(std::vector<double>&& numbers,
                                   const std::vector<pybind11::ssize_t>& shape);
pybind11::array_t<double> array_of(std::vector<double>&& numbers);

// Rows of one length, `columns`, as a matrix.
pybind11::array_t<double> matrix_of(const std::vector<std::vector<double>>& rows, int columns);

// n numbers. Throws std::invalid_argument "NAME: ..." for another shape and for numbers that are
// not finite.
std::vector<double> vector_of(const Array& array, const std::string& name, int n);

// A matrix of n columns and finite numbers. Throws std::invalid_argument likewise.
void check_rows(const Array& array, const std::string& name, int n);

}  // namespace carnot::python
