// Reference values: those of the project's own, and those that may stand beside the checkout.
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "carnot/numerics/linear_algebra.h"

#ifndef CARNOT_SOURCE_DIR
#define CARNOT_SOURCE_DIR "."
#endif

namespace carnot::test {

using Json = nlohmann::json;

// Null when the file does not exist.
inline Json read_json(const std::string& path) {
  std::ifstream file(path);
  if (!file) return {};
  return Json::parse(file);
}

// A file of tests/reference: always there.
inline Json own_reference(const std::string& name) {
  return read_json(std::string(CARNOT_SOURCE_DIR) + "/tests/reference/" + name);
}

// A file of the folder shared/reference beside the checkout: may be missing.
inline Json shared_reference(const std::string& name) {
  return read_json(std::string(CARNOT_SOURCE_DIR) + "/../shared/reference/" + name);
}

// Numbers are decimal strings, to carry more digits than a double.
inline double number(const Json& text) { return std::stod(text.get<std::string>()); }

template <int n>
Vector<double, n> numbers(const Json& texts) {
  Vector<double, n> v;
  for (int i = 0; i < n; ++i) v[i] = number(texts.at(static_cast<std::size_t>(i)));
  return v;
}

}  // namespace carnot::test
