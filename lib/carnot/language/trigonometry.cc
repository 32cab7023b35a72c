// The theorems of sines and cosines in sums. X is any product:
//
//   pythagoras   X sin^2 a + X cos^2 a = X
//   addition     X sin a cos b + X cos a sin b = X sin(a + b)
//                X cos a cos b + X sin a sin b = X cos(a - b),        and with minus
//   difference   X sin(c + d) - X sin c cos d = X cos c sin d
//                X cos(c + d) - X cos c cos d = -X sin c sin d
//                X cos(c + d) + X sin c sin d = X cos c cos d
//
// The last ones undo what the second ones made of a chain: along trailers, sin(a - c) - cos(b - c)
// sin(a - b) is one product.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "carnot/language/expression.h"

namespace carnot::language {

Expression Graph::circular(Operation operation, const Part& argument) {
  return function(operation, Expression{this, argument.factor, argument.node});
}

// Puts factor_i X result in the place of term i and of its partner, if that is there. `partner` and
// `result` have X in them; the partner has partner_factor times the coefficient of term i.
bool Graph::replace(std::vector<Part>& terms,
                    std::size_t i,
                    const Expression& partner,
                    double partner_factor,
                    const Expression& result) {
  if (partner.is_constant() && partner.node != 0) return false;
  const double wanted = terms[i].factor * partner_factor / partner.coefficient;
  const auto other = std::find(terms.begin(), terms.end(), Part{partner.node, wanted});
  if (other == terms.end() || other == terms.begin() + static_cast<std::ptrdiff_t>(i)) return false;
  const double factor = terms[i].factor * result.coefficient;
  terms[i] = {result.is_constant() ? 0 : result.node, factor};
  terms.erase(other);
  return true;
}

bool Graph::pythagoras(std::vector<Part>& terms, std::size_t i) {
  const std::vector<Part> parts = nodes_[terms[i].node].parts;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    const Node& sine = nodes_[parts[f].node];
    if (sine.operation != Operation::kSin || parts[f].factor < 2) continue;
    const Part argument = sine.parts[0];
    std::vector<Part> rest = parts;
    rest[f].factor -= 2;
    const Expression x = product_of(rest, 1);
    const Expression partner = product(x, power(circular(Operation::kCos, argument), 2));
    if (replace(terms, i, partner, 1, x)) return true;
  }
  return false;
}

bool Graph::addition(std::vector<Part>& terms, std::size_t i) {
  const std::vector<Part> parts = nodes_[terms[i].node].parts;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    for (std::size_t g = 0; g < parts.size(); ++g) {
      if (f == g || parts[f].factor < 1 || parts[g].factor < 1) continue;
      const Node first = nodes_[parts[f].node];
      const Node second = nodes_[parts[g].node];
      const bool sine = first.operation == Operation::kSin;
      if ((!sine && first.operation != Operation::kCos) || second.operation != Operation::kCos) {
        continue;
      }
      if (!sine && f > g) continue;
      const Part a = first.parts[0];
      const Part b = second.parts[0];
      if (a == b) continue;
      std::vector<Part> rest = parts;
      rest[f].factor -= 1;
      rest[g].factor -= 1;
      const Expression x = product_of(rest, 1);
      const Expression of_a{this, a.factor, a.node};
      const Expression of_b{this, b.factor, b.node};
      const Expression crossed = product(circular(sine ? Operation::kCos : Operation::kSin, a),
                                         circular(Operation::kSin, b));
      const Operation operation = sine ? Operation::kSin : Operation::kCos;
      for (const double sign : {1.0, -1.0}) {
        const Expression turned = function(operation, flat_sum(of_a, sign > 0 ? of_b : -of_b));
        const double partner = sine ? sign : -sign;
        if (replace(terms, i, product(x, crossed), partner, product(x, turned))) return true;
      }
    }
  }
  return false;
}

bool Graph::difference(std::vector<Part>& terms, std::size_t i) {
  const Node term = nodes_[terms[i].node];
  // Term i is X times one sine or cosine; a term that is one is no product.
  std::vector<Part> parts{{terms[i].node, 1}};
  if (term.operation == Operation::kProduct) parts = term.parts;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    const Node whole = nodes_[parts[f].node];
    const bool sine = whole.operation == Operation::kSin;
    if (parts[f].factor != 1 || (!sine && whole.operation != Operation::kCos)) continue;
    const Expression a{this, whole.parts[0].factor, whole.parts[0].node};
    std::vector<Part> rest = parts;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(f));
    const Expression x = product_of(rest, 1);
    for (std::size_t j = 0; j < terms.size(); ++j) {
      const Node other = nodes_[terms[j].node];
      if (j == i || other.operation != Operation::kProduct) continue;
      if (std::abs(terms[j].factor) != std::abs(terms[i].factor)) continue;
      if (other.parts.size() < 2 || other.parts.size() > parts.size() + 1) continue;
      for (const Part& g : other.parts) {
        for (const Part& h : other.parts) {
          const Node of_c = nodes_[g.node];
          const Node of_d = nodes_[h.node];
          const bool c_sine = of_c.operation == Operation::kSin;
          const bool d_sine = of_d.operation == Operation::kSin;
          const bool circular_both = (c_sine || of_c.operation == Operation::kCos) &&
                                     (d_sine || of_d.operation == Operation::kCos);
          if (&g == &h || !circular_both) continue;
          // sin a wants sin c cos d; cos a wants two of a kind.
          if (sine ? !(c_sine && !d_sine) : c_sine != d_sine) continue;
          const Part c = of_c.parts[0];
          const Part d = of_d.parts[0];
          const Expression at_c{this, c.factor, c.node};
          const Expression at_d{this, d.factor, d.node};
          for (const double s : {1.0, -1.0}) {
            // a = s c + r d?
            const Expression left = flat_sum(a, s > 0 ? -at_c : at_c);
            if (left.node != at_d.node ||
                std::abs(left.coefficient) != std::abs(at_d.coefficient)) {
              continue;
            }
            const double r = left.coefficient == at_d.coefficient ? 1 : -1;
            const Expression pair =
                product(Expression{this, 1, g.node}, Expression{this, 1, h.node});
            const Operation not_c = c_sine ? Operation::kCos : Operation::kSin;
            const Operation not_d = d_sine ? Operation::kCos : Operation::kSin;
            const Expression remains = product(circular(not_c, c), circular(not_d, d));
            double partner = -s;  // sin a = s sin c cos d + r cos c sin d
            double sign = r;
            if (!sine) {  // cos a = cos c cos d - s r sin c sin d
              partner = c_sine ? s * r : -1;
              sign = c_sine ? 1 : -s * r;
            }
            const Expression result = product(product(x, remains), number(sign));
            if (replace(terms, i, product(x, pair), partner, result)) return true;
          }
        }
      }
    }
  }
  return false;
}

bool Graph::simplify(std::vector<Part>& terms) {
  constexpr std::size_t kMost = 64;  // the work grows with the square
  if (terms.size() < 2 || terms.size() > kMost) return false;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Operation operation = nodes_[terms[i].node].operation;
    const bool is_product = operation == Operation::kProduct;
    if (is_product && (pythagoras(terms, i) || addition(terms, i))) return true;
    const bool circular = operation == Operation::kSin || operation == Operation::kCos;
    if ((is_product || circular) && difference(terms, i)) return true;
  }
  return false;
}

}  // namespace carnot::language
