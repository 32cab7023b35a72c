#include "carnot/language/expression.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "carnot/numerics/stumpff.h"

namespace carnot::language {
namespace {

constexpr std::uint32_t kOneNode = 0;
constexpr std::uint32_t kMostDepth = 2000;  // recursion follows it
constexpr int kMostExponent = 64;           // powers beyond are exp(e log x)

constexpr std::array<std::string_view, 13> kNames{"sin",
                                                  "cos",
                                                  "tan",
                                                  "exp",
                                                  "log",
                                                  "sqrt",
                                                  "sinh",
                                                  "cosh",
                                                  "tanh",
                                                  "asin",
                                                  "acos",
                                                  "atan",
                                                  "atan2"};

bool is_whole(double x) { return std::nearbyint(x) == x; }

}  // namespace

std::span<const std::string_view> function_names() { return kNames; }

bool find_function(std::string_view name, Operation& operation) {
  static const std::map<std::string_view, Operation> kFunctions{{"sin", Operation::kSin},
                                                                {"cos", Operation::kCos},
                                                                {"exp", Operation::kExp},
                                                                {"log", Operation::kLog},
                                                                {"sqrt", Operation::kSqrt},
                                                                {"sinh", Operation::kSinh},
                                                                {"cosh", Operation::kCosh},
                                                                {"tanh", Operation::kTanh},
                                                                {"asin", Operation::kAsin},
                                                                {"acos", Operation::kAcos},
                                                                {"atan", Operation::kAtan}};
  const auto found = kFunctions.find(name);
  if (found == kFunctions.end()) return false;
  operation = found->second;
  return true;
}

namespace {

double stumpff_value(int index, double x) {
  double result = std::nan("");
  [&]<int... k>(std::integer_sequence<int, k...>) {
    ((k == index ? void(result = carnot::stumpff<k>(x)) : void()), ...);
  }
  (std::make_integer_sequence<int, kMostStumpff + 1>{});
  return result;
}

}  // namespace

double apply(Operation operation, double x, int index) {
  switch (operation) {
    case Operation::kSin:
      return std::sin(x);
    case Operation::kCos:
      return std::cos(x);
    case Operation::kSqrt:
      return std::sqrt(x);
    case Operation::kExp:
      return std::exp(x);
    case Operation::kLog:
      return std::log(x);
    case Operation::kSinh:
      return std::sinh(x);
    case Operation::kCosh:
      return std::cosh(x);
    case Operation::kTanh:
      return std::tanh(x);
    case Operation::kAsin:
      return std::asin(x);
    case Operation::kAcos:
      return std::acos(x);
    case Operation::kAtan:
      return std::atan(x);
    case Operation::kStumpff:
      return stumpff_value(index, x);
    default:
      return std::nan("");
  }
}

Graph::Graph(int variables, std::size_t most) : variables_(variables), most_(most) {
  intern({});  // kOneNode
}

std::uint32_t Graph::intern(Node node) {
  bool finite = std::isfinite(node.constant);
  for (const Part& part : node.parts) {
    node.depth = std::max(node.depth, nodes_[part.node].depth + 1);
    finite = finite && std::isfinite(part.factor);
  }
  if (!finite) throw NotFinite("a constant is not finite");
  const auto [place, is_new] = known_.try_emplace(node, static_cast<std::uint32_t>(nodes_.size()));
  if (is_new) {
    if (nodes_.size() >= most_ || node.depth > kMostDepth) throw TooLarge("formulas too large");
    nodes_.push_back(std::move(node));
  }
  return place->second;
}

Expression Graph::number(double x) {
  if (!std::isfinite(x)) throw NotFinite("a constant is not finite");
  return {this, x, kOneNode};
}

Expression Graph::variable(int index) {
  Node node;
  node.operation = Operation::kVariable;
  node.index = static_cast<std::uint32_t>(index);
  return {this, 1, intern(node)};
}

Expression Graph::sum(std::span<const Expression> expressions) {
  double constant = 0;
  std::vector<Part> terms;
  const auto gather = [&] {
    std::sort(terms.begin(), terms.end());
    std::vector<Part> unique;
    for (const Part& part : terms) {
      if (part.node == kOneNode) {
        constant += part.factor;
      } else if (!unique.empty() && unique.back().node == part.node) {
        unique.back().factor += part.factor;
      } else {
        unique.push_back(part);
      }
    }
    std::erase_if(unique, [](const Part& part) { return part.factor == 0; });
    terms = std::move(unique);
  };
  for (const Expression& e : expressions) {
    if (!e.is_zero()) terms.push_back({e.node, e.coefficient});
  }
  gather();
  while (simplify(terms)) gather();
  if (terms.empty()) return number(constant);
  if (constant == 0 && terms.size() == 1) return {this, terms[0].factor, terms[0].node};
  if (constant == 0) {
    if (const std::vector<Part> common = common_factors(terms); !common.empty()) {
      std::vector<Expression> rest;
      rest.reserve(terms.size());
      for (const Part& part : terms) rest.push_back(divided(part, common));
      return product(product_of(common, 1), sum(rest));
    }
  }
  // A factor that all terms have, but for the sign, stays outside.
  double factor = terms[0].factor;
  for (const Part& part : terms) {
    if (std::abs(part.factor) != std::abs(factor)) factor = factor < 0 ? -1 : 1;
  }
  if (constant != 0 && std::abs(constant) != std::abs(factor)) factor = factor < 0 ? -1 : 1;
  Node node;
  node.operation = Operation::kSum;
  for (Part& part : terms) part.factor /= factor;
  node.constant = constant / factor;
  node.parts = std::move(terms);
  return {this, factor, intern(std::move(node))};
}

// The nodes that are factors of all terms, each to the power that all of them have.
std::vector<Part> Graph::common_factors(const std::vector<Part>& terms) const {
  const auto parts_of = [&](const Part& term) {
    const Node& node = nodes_[term.node];
    return node.operation == Operation::kProduct ? node.parts : std::vector<Part>{{term.node, 1}};
  };
  std::vector<Part> common = parts_of(terms[0]);
  for (std::size_t i = 1; i < terms.size() && !common.empty(); ++i) {
    const std::vector<Part> parts = parts_of(terms[i]);
    for (Part& shared : common) {
      const auto same = std::find_if(
          parts.begin(), parts.end(), [&](const Part& p) { return p.node == shared.node; });
      if (same == parts.end() || same->factor * shared.factor < 0) {
        shared.factor = 0;
      } else if (std::abs(same->factor) < std::abs(shared.factor)) {
        shared.factor = same->factor;
      }
    }
    std::erase_if(common, [](const Part& part) { return part.factor == 0; });
  }
  return common;
}

// The term without these factors.
Expression Graph::divided(const Part& term, const std::vector<Part>& factors) {
  const Node& node = nodes_[term.node];
  std::vector<Part> parts{{term.node, 1}};
  if (node.operation == Operation::kProduct) parts = node.parts;
  for (const Part& factor : factors) {
    for (Part& part : parts) {
      if (part.node == factor.node) part.factor -= factor.factor;
    }
  }
  return product_of(std::move(parts), term.factor);
}

Expression Graph::flat_sum(const Expression& a, const Expression& b) {
  std::vector<Expression> terms;
  for (const Expression& e : {a, b}) {
    const Node node = nodes_[e.node];
    if (e.is_constant() || node.operation != Operation::kSum) {
      terms.push_back(e);
      continue;
    }
    terms.push_back(number(e.coefficient * node.constant));
    for (const Part& part : node.parts) {
      terms.push_back({this, e.coefficient * part.factor, part.node});
    }
  }
  return sum(terms);
}

// coefficient times the product of the parts, where each node occurs once but in any order.
Expression Graph::product_of(std::vector<Part> parts, double coefficient) {
  if (coefficient == 0) return number(0);
  std::erase_if(parts, [](const Part& part) { return part.factor == 0; });
  // sqrt(x)^2 = x.
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Node& root = nodes_[parts[i].node];
    if (root.operation != Operation::kSqrt || std::abs(parts[i].factor) < 2) continue;
    const double whole = std::trunc(parts[i].factor / 2);
    const Part inside = root.parts[0];
    std::vector<Part> rest = parts;
    rest[i].factor -= 2 * whole;
    return product(product_of(rest, coefficient),
                   power(Expression{this, inside.factor, inside.node}, whole));
  }
  if (parts.empty()) return number(coefficient);
  if (parts.size() == 1 && parts[0].factor == 1) return {this, coefficient, parts[0].node};
  std::sort(parts.begin(), parts.end());
  Node node;
  node.operation = Operation::kProduct;
  node.parts = std::move(parts);
  return {this, coefficient, intern(std::move(node))};
}

Expression Graph::product(const Expression& a, const Expression& b) {
  const double coefficient = a.coefficient * b.coefficient;
  if (a.is_constant()) return {this, coefficient, coefficient == 0 ? kOneNode : b.node};
  if (b.is_constant()) return {this, coefficient, coefficient == 0 ? kOneNode : a.node};
  std::vector<Part> parts;
  for (const Expression& e : {a, b}) {
    const Node& node = nodes_[e.node];
    if (node.operation == Operation::kProduct) {
      parts.insert(parts.end(), node.parts.begin(), node.parts.end());
    } else {
      parts.push_back({e.node, 1});
    }
  }
  std::sort(parts.begin(), parts.end());
  std::vector<Part> unique;
  for (const Part& part : parts) {
    if (!unique.empty() && unique.back().node == part.node) {
      unique.back().factor += part.factor;
    } else {
      unique.push_back(part);
    }
  }
  return product_of(std::move(unique), coefficient);
}

Expression Graph::power(const Expression& a, double exponent) {
  if (exponent == 0) return number(1);
  if (exponent == 1) return a;
  if (a.is_constant()) return number(std::pow(a.coefficient, exponent));
  if (is_whole(2 * exponent) && !is_whole(exponent) && std::abs(exponent) < kMostExponent) {
    return power(function(Operation::kSqrt, a), 2 * exponent);
  }
  if (!is_whole(exponent) || std::abs(exponent) > kMostExponent) {
    const Expression logarithm = function(Operation::kLog, a);
    return function(Operation::kExp, product(number(exponent), logarithm));
  }
  const Node& node = nodes_[a.node];
  std::vector<Part> parts{{a.node, 1}};
  if (node.operation == Operation::kProduct) parts = node.parts;
  for (Part& part : parts) part.factor *= exponent;
  return product_of(std::move(parts), std::pow(a.coefficient, exponent));
}

Expression Graph::function(Operation operation, const Expression& a) {
  if (a.is_constant()) return number(apply(operation, a.coefficient));
  if (operation == Operation::kSin || operation == Operation::kCos) {
    const Node inner = nodes_[a.node];
    if (inner.operation == Operation::kSqrt) {
      const Expression inside{this, inner.parts[0].factor, inner.parts[0].node};
      const Expression square = product(number(a.coefficient * a.coefficient), inside);
      if (operation == Operation::kCos) return stumpff(0, square);
      return product(a, stumpff(1, square));
    }
  }
  const bool even = operation == Operation::kCos || operation == Operation::kCosh;
  const bool odd = operation == Operation::kSin || operation == Operation::kSinh ||
                   operation == Operation::kTanh || operation == Operation::kAsin ||
                   operation == Operation::kAtan;
  const bool turned = a.coefficient < 0 && (even || odd);
  Node node;
  node.operation = operation;
  node.parts = {{a.node, turned ? -a.coefficient : a.coefficient}};
  return {this, turned && odd ? -1.0 : 1.0, intern(std::move(node))};
}

Expression Graph::atan2(const Expression& y, const Expression& x) {
  if (y.is_constant() && x.is_constant()) {
    return number(std::atan2(y.coefficient, x.coefficient));
  }
  Node node;
  node.operation = Operation::kAtan2;
  const auto part = [](const Expression& e) {
    return e.is_constant() ? Part{kOneNode, e.coefficient} : Part{e.node, e.coefficient};
  };
  node.parts = {part(y), part(x)};
  return {this, 1, intern(std::move(node))};
}

Expression Graph::stumpff(int k, const Expression& a) {
  if (k > kMostStumpff) throw TooLarge("too many derivatives of a Stumpff function");
  if (a.is_constant()) return number(apply(Operation::kStumpff, a.coefficient, k));
  Node node;
  node.operation = Operation::kStumpff;
  node.index = static_cast<std::uint32_t>(k);
  node.parts = {{a.node, a.coefficient}};
  return {this, 1, intern(std::move(node))};
}

Expression Graph::whole(const Expression& a) {
  const Operation operation = nodes_[a.node].operation;
  const bool composed = operation == Operation::kSum || operation == Operation::kProduct;
  if (a.is_constant() || !composed) return a;
  Node node;
  node.operation = Operation::kWhole;
  node.parts = {{a.node, a.coefficient}};
  return {this, 1, intern(std::move(node))};
}

Expression operator+(const Expression& a, const Expression& b) {
  return a.graph->sum(std::array{a, b});
}
Expression operator-(const Expression& a, const Expression& b) {
  return a.graph->sum(std::array{a, -b});
}
Expression operator*(const Expression& a, const Expression& b) { return a.graph->product(a, b); }
Expression operator/(const Expression& a, const Expression& b) {
  return a.graph->product(a, a.graph->power(b, -1));
}
Expression operator-(const Expression& a) { return {a.graph, -a.coefficient, a.node}; }
Expression operator*(double a, const Expression& b) {
  return b.graph->product(b.graph->number(a), b);
}

}  // namespace carnot::language
