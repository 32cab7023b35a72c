// Derivatives, substitution and values of expressions: what goes through a formula node by node.
#include <array>
#include <cmath>
#include <cstddef>
#include <unordered_map>
#include <vector>

#include "carnot/language/expression.h"

namespace carnot::language {

Expression Graph::derivative_of_node(std::uint32_t id, int variable) {
  const auto key = std::pair(id, variable);
  if (const auto known = derivatives_.find(key); known != derivatives_.end()) return known->second;
  const Node node = nodes_[id];  // a copy: the graph grows
  const auto argument = [&](std::size_t i) {
    return Expression{this, node.parts[i].factor, node.parts[i].node};
  };
  const auto slope = [&](std::size_t i) { return derivative(argument(i), variable); };
  const Expression self{this, 1, id};
  Expression result = number(0);
  switch (node.operation) {
    case Operation::kOne:
      break;
    case Operation::kVariable:
      result = number(static_cast<int>(node.index) == variable ? 1 : 0);
      break;
    case Operation::kSum: {
      std::vector<Expression> terms;
      for (std::size_t i = 0; i < node.parts.size(); ++i) terms.push_back(slope(i));
      result = sum(terms);
      break;
    }
    case Operation::kProduct: {
      std::vector<Expression> terms;
      for (std::size_t i = 0; i < node.parts.size(); ++i) {
        const Expression d = derivative_of_node(node.parts[i].node, variable);
        if (d.is_zero()) continue;
        std::vector<Part> rest = node.parts;
        rest[i].factor -= 1;
        terms.push_back(product(product_of(rest, node.parts[i].factor), d));
      }
      result = sum(terms);
      break;
    }
    case Operation::kAtan2: {
      const Expression y = argument(0);
      const Expression x = argument(1);
      const Expression square = power(x, 2) + power(y, 2);
      result = (x * slope(0) - y * slope(1)) / square;
      break;
    }
    default: {
      const Expression d = slope(0);
      if (d.is_zero()) break;
      const Expression x = argument(0);
      switch (node.operation) {
        case Operation::kSin:
          result = function(Operation::kCos, x) * d;
          break;
        case Operation::kCos:
          result = -(function(Operation::kSin, x) * d);
          break;
        case Operation::kSqrt:
          result = 0.5 * (d / self);
          break;
        case Operation::kExp:
          result = self * d;
          break;
        case Operation::kLog:
          result = d / x;
          break;
        case Operation::kSinh:
          result = function(Operation::kCosh, x) * d;
          break;
        case Operation::kCosh:
          result = function(Operation::kSinh, x) * d;
          break;
        case Operation::kTanh:
          result = (number(1) - power(self, 2)) * d;
          break;
        case Operation::kAsin:
          result = d / function(Operation::kSqrt, number(1) - power(x, 2));
          break;
        case Operation::kAcos:
          result = -(d / function(Operation::kSqrt, number(1) - power(x, 2)));
          break;
        case Operation::kAtan:
          result = d / (number(1) + power(x, 2));
          break;
        case Operation::kWhole:
          result = d;
          break;
        case Operation::kStumpff: {
          // c_k' = (k c_(k+2) - c_(k+1)) / 2.
          const int k = static_cast<int>(node.index);
          const Expression next = stumpff(k + 1, x);
          result = -(0.5 * next * d);
          if (k > 0) result = result + (0.5 * k) * stumpff(k + 2, x) * d;
          break;
        }
        default:
          break;
      }
    }
  }
  derivatives_.emplace(key, result);
  return result;
}

Expression Graph::derivative(const Expression& a, int variable) {
  if (a.is_constant()) return number(0);
  return product(number(a.coefficient), derivative_of_node(a.node, variable));
}

// The node with other arguments.
Expression Graph::of_parts(const Node& node, std::span<const Expression> arguments) {
  switch (node.operation) {
    case Operation::kSum: {
      std::vector<Expression> terms(arguments.begin(), arguments.end());
      terms.push_back(number(node.constant));
      return sum(terms);
    }
    case Operation::kProduct: {
      Expression result = number(1);
      for (std::size_t i = 0; i < arguments.size(); ++i) {
        result = product(result, power(arguments[i], node.parts[i].factor));
      }
      return result;
    }
    case Operation::kAtan2:
      return atan2(arguments[0], arguments[1]);
    case Operation::kStumpff:
      return stumpff(static_cast<int>(node.index), arguments[0]);
    case Operation::kWhole:
      return whole(arguments[0]);
    default:
      return function(node.operation, arguments[0]);
  }
}

Expression Graph::substitute(const Expression& a, int first, std::span<const Expression> values) {
  std::unordered_map<std::uint32_t, Expression> done;
  const auto visit = [&](const auto& self, std::uint32_t id) -> Expression {
    if (const auto known = done.find(id); known != done.end()) return known->second;
    const Node node = nodes_[id];
    Expression result{this, 1, id};
    if (node.operation == Operation::kVariable) {
      const int i = static_cast<int>(node.index) - first;
      if (0 <= i && i < static_cast<int>(values.size())) result = values[i];
    } else if (node.operation != Operation::kOne) {
      std::vector<Expression> arguments;
      for (const Part& part : node.parts) {
        const Expression inner = self(self, part.node);
        const bool scaled = node.operation != Operation::kProduct;
        arguments.push_back(scaled ? product(number(part.factor), inner) : inner);
      }
      result = of_parts(node, arguments);
    }
    done.emplace(id, result);
    return result;
  };
  if (a.is_constant()) return a;
  return product(number(a.coefficient), visit(visit, a.node));
}

bool Graph::depends(const Expression& a, int first, int count) {
  if (a.is_constant()) return false;
  std::unordered_map<std::uint32_t, bool> done;
  const auto visit = [&](const auto& self, std::uint32_t id) -> bool {
    if (const auto known = done.find(id); known != done.end()) return known->second;
    const Node& node = nodes_[id];
    bool result = false;
    if (node.operation == Operation::kVariable) {
      const int i = static_cast<int>(node.index) - first;
      result = 0 <= i && i < count;
    }
    for (const Part& part : node.parts) result = result || self(self, part.node);
    done.emplace(id, result);
    return result;
  };
  return visit(visit, a.node);
}

double Graph::evaluate(const Expression& a, std::span<const double> variables) {
  if (a.is_constant()) return a.coefficient;
  std::unordered_map<std::uint32_t, double> done;
  const auto visit = [&](const auto& self, std::uint32_t id) -> double {
    if (const auto known = done.find(id); known != done.end()) return known->second;
    const Node& node = nodes_[id];
    double result = 1;
    switch (node.operation) {
      case Operation::kOne:
        break;
      case Operation::kVariable:
        result = variables[node.index];
        break;
      case Operation::kSum:
        result = node.constant;
        for (const Part& part : node.parts) result += part.factor * self(self, part.node);
        break;
      case Operation::kProduct:
        for (const Part& part : node.parts) result *= std::pow(self(self, part.node), part.factor);
        break;
      case Operation::kAtan2:
        result = std::atan2(node.parts[0].factor * self(self, node.parts[0].node),
                            node.parts[1].factor * self(self, node.parts[1].node));
        break;
      case Operation::kWhole:
        result = node.parts[0].factor * self(self, node.parts[0].node);
        break;
      default:
        result = apply(node.operation,
                       node.parts[0].factor * self(self, node.parts[0].node),
                       static_cast<int>(node.index));
    }
    done.emplace(id, result);
    return result;
  };
  return a.coefficient * visit(visit, a.node);
}

}  // namespace carnot::language
