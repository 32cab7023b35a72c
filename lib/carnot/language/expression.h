// Formulas as a graph in which equal parts are one node.
//
// An Expression is a number times a node. Nodes are kept in a normal form, so that x + x is 2x, x -
// x is nothing, and two formulas that are written alike are the same node:
//
//   sum      c0 + c1 n1 + c2 n2 + ... with the nodes in order, each once; the first c is positive.
//            What is a factor of all terms stays outside.
//   product  n1^e1 n2^e2 ... with whole exponents, the nodes in order, each once; a division is a
//            negative exponent, so that quotients by the same node share its reciprocal.
//   others   a function of one or two expressions. sin(-x) = -sin(x), cos(-x) = cos(x). The cosine
//            of a root and the sine of one over it are Stumpff functions, which are smooth at zero.
//
// Sums know the theorems of sines and cosines (trigonometry.cc), which turns the frame and B'M B of
// most vehicles into what one would write by hand. Nothing else is multiplied out.
//
// The graph only grows. It belongs to one thread; what is made of it (tape.h) is shared freely.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

namespace carnot::language {

enum class Operation : std::uint8_t {
  kOne,       // the constant 1
  kVariable,  // number `index` of the graph
  kSum,
  kProduct,
  kSin,
  kCos,
  kSqrt,
  kExp,
  kLog,
  kSinh,
  kCosh,
  kTanh,
  kAsin,
  kAcos,
  kAtan,
  kAtan2,
  kStumpff,  // c_k of numerics/stumpff.h, k = index
  kWhole,    // its argument, which is not taken apart: products and sums around it stay outside
};

// Formulas may not grow without bound: files are untrusted.
struct TooLarge : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A number in a formula is infinite or not a number.
struct NotFinite : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Graph;

// coefficient x node. It is a value; the graph must outlive it.
struct Expression {
  Graph* graph = nullptr;
  double coefficient = 0;
  std::uint32_t node = 0;

  [[nodiscard]] bool is_constant() const { return node == 0 || coefficient == 0; }
  [[nodiscard]] bool is_zero() const { return coefficient == 0; }
  [[nodiscard]] bool is(double x) const { return is_constant() && coefficient == x; }
};

// A term of a sum: factor times node. A factor of a product: node to a whole power.
struct Part {
  std::uint32_t node = 0;
  double factor = 0;
  friend auto operator<=>(const Part&, const Part&) = default;  // NOLINT(modernize-use-nullptr)
};

struct Node {
  Operation operation = Operation::kOne;
  std::uint32_t index = 0;    // of a variable or a Stumpff function
  double constant = 0;        // of a sum
  std::vector<Part> parts{};  // of a sum or product; the arguments of a function, times factors
  std::uint32_t depth = 0;    // of the formula
  // clang-tidy 14 sees a zero for nullptr in what the compiler makes of this.
  friend auto operator<=>(const Node&, const Node&) = default;  // NOLINT(modernize-use-nullptr)
};

class Graph {
 public:
  // `variables` of them, and at most `most` nodes: beyond that TooLarge is thrown. All functions
  // that make expressions throw that, and NotFinite.
  explicit Graph(int variables, std::size_t most = kMostNodes);
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;

  Expression number(double x);
  Expression variable(int index);
  Expression sum(std::span<const Expression> terms);
  Expression product(const Expression& a, const Expression& b);
  // a^exponent. Half-integers are roots; any other exponent is exp(exponent log a).
  Expression power(const Expression& a, double exponent);
  Expression function(Operation operation, const Expression& a);
  Expression atan2(const Expression& y, const Expression& x);
  // a as a node of its own, which products and sums do not take apart: for what is computed once
  // and used often.
  Expression whole(const Expression& a);
  // c_k(a) for a >= 0, k <= kMostStumpff.
  Expression stumpff(int k, const Expression& a);

  // d a / d variable.
  Expression derivative(const Expression& a, int variable);
  // a with values[i] in place of variable first + i.
  Expression substitute(const Expression& a, int first, std::span<const Expression> values);
  // Whether a depends on any of the variables first, ..., first + count - 1.
  bool depends(const Expression& a, int first, int count);
  // The value of a where the variables have these values.
  double evaluate(const Expression& a, std::span<const double> variables);

  [[nodiscard]] const Node& node(std::uint32_t id) const { return nodes_[id]; }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] int variables() const { return variables_; }

  static constexpr std::size_t kMostNodes = 200000;

 private:
  std::uint32_t intern(Node node);
  Expression derivative_of_node(std::uint32_t id, int variable);
  Expression of_parts(const Node& node, std::span<const Expression> arguments);
  Expression product_of(std::vector<Part> parts, double coefficient);
  [[nodiscard]] std::vector<Part> common_factors(const std::vector<Part>& terms) const;
  Expression divided(const Part& term, const std::vector<Part>& factors);
  // a + b where sums among them are taken apart.
  Expression flat_sum(const Expression& a, const Expression& b);

  // trigonometry.cc: each is true where it has made two terms one, or shorter.
  bool simplify(std::vector<Part>& terms);
  bool pythagoras(std::vector<Part>& terms, std::size_t i);
  bool addition(std::vector<Part>& terms, std::size_t i);
  bool difference(std::vector<Part>& terms, std::size_t i);
  Expression circular(Operation operation, const Part& argument);
  bool replace(std::vector<Part>& terms,
               std::size_t i,
               const Expression& partner,
               double partner_factor,
               const Expression& result);

  int variables_;
  std::size_t most_;
  std::vector<Node> nodes_;
  std::map<Node, std::uint32_t> known_;
  std::map<std::pair<std::uint32_t, int>, Expression> derivatives_;
};

Expression operator+(const Expression& a, const Expression& b);
Expression operator-(const Expression& a, const Expression& b);
Expression operator*(const Expression& a, const Expression& b);
Expression operator/(const Expression& a, const Expression& b);
Expression operator-(const Expression& a);
Expression operator*(double a, const Expression& b);

// What the language calls a function of one argument, for example "sin"; and the reverse.
bool find_function(std::string_view name, Operation& operation);
std::span<const std::string_view> function_names();

// The value of a function of one number; `index` is that of a Stumpff function.
double apply(Operation operation, double x, int index = 0);

// c_0 and three derivatives of it.
inline constexpr int kMostStumpff = 8;

}  // namespace carnot::language
