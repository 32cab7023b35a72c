// The grammar of docs/scene_language.md, read from left to right without going back.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <sstream>
#include <utility>

#include "carnot/language/lexer.h"
#include "carnot/language/nearest.h"
#include "carnot/language/scene_source.h"

namespace carnot::language {
namespace {

// Files are untrusted: what is read from them is bounded.
constexpr std::size_t kMostCharacters = 200000;
constexpr int kMostNesting = 200;
constexpr std::size_t kMostItems = 200;  // parameters, rows, drawn lines, ...

constexpr std::array kKeywords{
    "coordinates", "parameters",  "controls",  "let",   "kinetic", "mass",  "potential",
    "lagrangian",  "hamiltonian", "structure", "basis", "cost",    "chart", "guess",
    "symmetry",    "period",      "draw",      "path",  "report",  "name",  "summary",
    "reference",   "limit",       "point",     "disc"};

// Functions that people look for, and why they are not there.
struct Refused {
  std::string_view name;
  std::string_view advice;
};
constexpr std::array kRefused{
    Refused{"abs", "it has a kink; write sqrt(x^2 + c^2) with a small c"},
    Refused{"sign", "it jumps; write tanh(x / c) with a small c"},
    Refused{"min", "it has a kink; write a smooth function"},
    Refused{"max", "it has a kink; write a smooth function"},
    Refused{"floor", "it jumps; write a smooth function"},
    Refused{"ceil", "it jumps; write a smooth function"},
    Refused{"mod", "it jumps; an angle needs no reduction, and other coordinates have period"},
    Refused{"ln", "write log"},
    Refused{"arcsin", "write asin"},
    Refused{"arccos", "write acos"},
    Refused{"arctan", "write atan"},
    Refused{"cot", "write cos(x) / sin(x)"},
    Refused{"sec", "write 1 / cos(x)"},
    Refused{"csc", "write 1 / sin(x)"}};

std::string line_of(std::string_view text, int line) {
  std::size_t begin = 0;
  for (int i = 1; i < line && begin != std::string_view::npos; ++i) {
    begin = text.find('\n', begin);
    if (begin != std::string_view::npos) ++begin;
  }
  if (begin == std::string_view::npos) return "";
  std::string result(text.substr(begin, text.find('\n', begin) - begin));
  // Control characters are not for a terminal; the caret counts columns.
  for (char& c : result) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return result;
}

std::string quote(const Token& token) {
  if (token.kind == Token::Kind::kLineEnd || token.kind == Token::Kind::kEnd)
    return "the line ends";
  return "'" + token.text + "'";
}

class Parser {
 public:
  Parser(std::string_view text,
         const std::string& name,
         const std::string& file,
         const ParameterSettings& settings)
      : text_(text), file_(file), settings_(settings) {
    scene_.name = name;
    scene_.graph = std::make_unique<Graph>(kVariables);
  }

  SceneSource run() {
    if (text_.size() > kMostCharacters) {
      fail({1, 1}, "the text is too long; accepted: at most 200000 characters");
    }
    std::string comment;
    tokens_ = tokens_of(text_, &comment);
    summary_of(comment);
    try {
      while (now().kind != Token::Kind::kEnd) {
        if (now().kind == Token::Kind::kLineEnd) {
          ++at_;
        } else {
          statement();
        }
      }
    } catch (const TooLarge&) {
      fail(now().place, "the formulas are too large");
    } catch (const NotFinite&) {
      fail(last().place, "a constant here is infinite or not a number");
    }
    if (scene_.coordinates.empty()) {
      fail({1, 1}, "there are no coordinates; accepted: a line such as coordinates x, y [length]");
    }
    add_discs();
    for (const auto& setting : settings_) {
      const bool known = std::any_of(scene_.parameters.begin(),
                                     scene_.parameters.end(),
                                     [&](const auto& p) { return p.name == setting.first; });
      if (!known) throw std::invalid_argument("there is no parameter " + setting.first);
    }
    return std::move(scene_);
  }

 private:
  // ---- tokens
  const Token& now() const { return tokens_[at_]; }
  const Token& last() const { return tokens_[at_ > 0 ? at_ - 1 : 0]; }
  const Token& after() const { return tokens_[std::min(at_ + 1, tokens_.size() - 1)]; }
  bool is_mark(std::string_view mark) const {
    return now().kind == Token::Kind::kMark && now().text == mark;
  }
  bool take(std::string_view mark) {
    if (!is_mark(mark)) return false;
    ++at_;
    return true;
  }
  void expect(std::string_view mark, std::string_view where) {
    if (!take(mark)) unexpected("'" + std::string(mark) + "' " + std::string(where));
  }
  Token expect_name(const std::string& what) {
    if (now().kind != Token::Kind::kName) unexpected(what);
    return tokens_[at_++];
  }
  void expect_line_end() {
    if (now().kind != Token::Kind::kLineEnd) unexpected("an operator or the end of the line");
  }
  [[noreturn]] void fail(const Place& place, const std::string& what) const {
    refuse_text(text_, file_, place, what);
  }
  [[noreturn]] void unexpected(const std::string& accepted) const {
    const Token& token = now();
    if (token.kind == Token::Kind::kBad) {
      fail(token.place, "'" + token.text + "' is not part of the language; accepted: " + accepted);
    }
    const bool ended = token.kind == Token::Kind::kLineEnd || token.kind == Token::Kind::kEnd;
    fail(token.place,
         (ended ? quote(token) + " here" : quote(token) + " is not expected") +
             "; accepted: " + accepted);
  }

  // ---- names
  std::vector<std::string> known_names() const {
    std::vector<std::string> names{"t", "pi"};
    for (const auto& [name, meaning] : names_) names.push_back(name);
    for (const std::string_view function : function_names()) names.emplace_back(function);
    return names;
  }

  // A new name, which must not be taken.
  void define(const Token& name, const Expression& meaning) {
    const bool reserved = name.text == "t" || name.text == "pi" ||
                          std::any_of(function_names().begin(),
                                      function_names().end(),
                                      [&](std::string_view f) { return f == name.text; });
    if (reserved)
      fail(name.place, "'" + name.text + "' is a word of the language; take another name");
    if (!names_.emplace(name.text, meaning).second) {
      fail(name.place, "'" + name.text + "' is defined twice");
    }
    if (names_.size() > kMostItems) fail(name.place, "there are too many names");
  }

  // The number of the coordinate of that name, or -1.
  int numbered(const std::string& name) const {
    for (int i = 0; i < scene_.dof(); ++i) {
      if (scene_.coordinates[i].name == name) return i;
    }
    return -1;
  }
  int coordinate(const Token& name) const { return numbered(name.text); }

  int expect_coordinate() {
    const Token name = expect_name("the name of a coordinate");
    const int i = coordinate(name);
    if (i < 0) {
      std::vector<std::string> names;
      for (const Coordinate& c : scene_.coordinates) names.push_back(c.name);
      std::string accepted;
      for (const std::string& n : names) accepted += (accepted.empty() ? "" : ", ") + n;
      fail(name.place,
           "'" + name.text + "' is no coordinate" + suggestion(name.text, names) +
               "; accepted: " + accepted);
    }
    return i;
  }

  // ---- expressions
  Expression expression() {
    std::vector<Expression> terms;
    const bool negative = sign();
    Expression first = term();
    terms.push_back(negative ? -first : first);
    while (is_mark("+") || is_mark("-")) {
      const bool minus = sign();
      const Expression next = term();
      terms.push_back(minus ? -next : next);
    }
    return terms.size() == 1 ? terms[0] : scene_.graph->sum(terms);
  }

  bool sign() {
    bool negative = false;
    while (is_mark("-") || is_mark("+")) {
      if (now().text == "-") negative = !negative;
      ++at_;
    }
    return negative;
  }

  bool begins_factor() const {
    return now().kind == Token::Kind::kName || now().kind == Token::Kind::kNumber || is_mark("(");
  }

  Expression term() {
    Expression result = factor();
    while (true) {
      if (take("*")) {
        const bool negative = sign();
        const Expression next = factor();
        result = result * (negative ? -next : next);
      } else if (is_mark("/")) {
        const Place place = now().place;
        ++at_;
        const bool negative = sign();
        const Expression next = factor();
        if (next.is_zero()) fail(place, "division by zero");
        result = result / (negative ? -next : next);
      } else if (begins_factor()) {
        result = result * factor();
      } else {
        return result;
      }
    }
  }

  Expression factor() {
    const Expression base = primary();
    if (!is_mark("^")) return base;
    const Place place = now().place;
    ++at_;
    const bool negative = sign();
    Expression exponent = factor();
    if (negative) exponent = -exponent;
    if (!exponent.is_constant()) {
      Graph& graph = *scene_.graph;
      return graph.function(Operation::kExp, exponent * graph.function(Operation::kLog, base));
    }
    if (base.is_zero() && exponent.coefficient < 0) fail(place, "division by zero");
    return scene_.graph->power(base, exponent.coefficient);
  }

  Expression primary() {
    if (++nesting_ > kMostNesting) fail(now().place, "the formula is nested too deeply");
    Expression result;
    if (now().kind == Token::Kind::kNumber) {
      result = scene_.graph->number(now().number);
      ++at_;
    } else if (is_mark("(")) {
      const Place open = now().place;
      ++at_;
      result = expression();
      close(open);
    } else if (now().kind == Token::Kind::kName) {
      result = named();
    } else {
      unexpected("a number, a name or '('");
    }
    --nesting_;
    return result;
  }

  void close(const Place& open) {
    if (take(")")) return;
    unexpected("an operator, or ')' for the '(' in line " + std::to_string(open.line) +
               ", column " + std::to_string(open.column));
  }

  Expression named() {
    const Token name = tokens_[at_++];
    Graph& graph = *scene_.graph;
    if (const int i = coordinate(name); i >= 0) {
      if (!is_mark("'")) return graph.variable(kConfiguration.first + i);
      ++at_;
      if (is_mark("'")) {
        fail(now().place,
             "second derivatives have no place in a scene of first order; make the "
             "velocity a coordinate, as in x' = v, v' = u");
      }
      return graph.variable(kVelocity.first + i);
    }
    if (is_mark("'")) {
      fail(name.place, "only coordinates have velocities, and '" + name.text + "' is none");
    }
    if (name.text == "t") return graph.variable(kTime.first);
    if (name.text == "pi") return graph.number(std::numbers::pi);
    if (const auto known = names_.find(name.text); known != names_.end()) return known->second;
    if (knows_momenta_ && name.text.rfind("p_", 0) == 0) {
      Token of = name;
      of.text = name.text.substr(2);
      if (const int i = coordinate(of); i >= 0) return graph.variable(kMomentum.first + i);
    }
    if (is_mark("(")) return call(name);
    fail(name.place,
         "'" + name.text + "' is not known" + suggestion(name.text, known_names()) +
             "; names are defined above the line that uses them");
  }

  Expression call(const Token& name) {
    Graph& graph = *scene_.graph;
    for (const Refused& refused : kRefused) {
      if (refused.name == name.text) {
        fail(name.place,
             "'" + name.text + "' is not part of the language: " + std::string(refused.advice));
      }
    }
    const auto functions = function_names();
    if (std::find(functions.begin(), functions.end(), name.text) == functions.end()) {
      std::vector<std::string> known(functions.begin(), functions.end());
      std::string accepted;
      for (const std::string& f : known) accepted += (accepted.empty() ? "" : ", ") + f;
      fail(name.place,
           "'" + name.text + "' is neither a name nor a function" +
               suggestion(name.text, known_names()) + "; accepted: " + accepted);
    }
    const Place open = now().place;
    ++at_;
    const Expression a = expression();
    if (name.text == "atan2") {
      expect(",", "between the two arguments of atan2");
      const Expression b = expression();
      close(open);
      return graph.atan2(a, b);
    }
    close(open);
    if (name.text == "tan") {
      return graph.function(Operation::kSin, a) / graph.function(Operation::kCos, a);
    }
    Operation operation{};
    find_function(name.text, operation);
    return graph.function(operation, a);
  }

  double constant(const std::string& what) {
    const Place place = now().place;
    const Expression e = expression();
    if (!e.is_constant()) fail(place, what + " is not a constant");
    return e.coefficient;
  }

  // [a, b; c, d], [[a, b], [c, d]] or diag(a, b, c).
  MatrixFormula matrix() {
    MatrixFormula m;
    m.place = now().place;
    std::vector<std::vector<Expression>> rows;
    if (now().kind == Token::Kind::kName && now().text == "diag") {
      ++at_;
      expect("(", "after diag");
      const std::vector<Expression> diagonal = list();
      expect(")", "at the end of the matrix");
      for (std::size_t i = 0; i < diagonal.size(); ++i) {
        rows.emplace_back(diagonal.size(), scene_.graph->number(0));
        rows[i][i] = diagonal[i];
      }
    } else {
      expect("[", "where a matrix begins, or diag(...)");
      if (is_mark("[")) {
        do {
          expect("[", "where a row begins");
          rows.push_back(list());
          expect("]", "at the end of the row");
        } while (take(",") || take(";"));
      } else {
        do {
          rows.push_back(list());
        } while (take(";"));
      }
      expect("]", "at the end of the matrix");
    }
    m.rows = static_cast<int>(rows.size());
    m.columns = static_cast<int>(rows[0].size());
    for (const auto& row : rows) {
      if (static_cast<int>(row.size()) != m.columns) fail(m.place, "rows of different lengths");
      m.entries.insert(m.entries.end(), row.begin(), row.end());
    }
    return m;
  }

  std::vector<Expression> list() {
    std::vector<Expression> items;
    do {
      items.push_back(expression());
      if (items.size() > kMostItems) fail(now().place, "the list is too long");
    } while (take(","));
    return items;
  }

  // ---- statements
  // "# hooked.scene: a robot with a trailer" is a summary, too.
  void summary_of(const std::string& comment) {
    const std::size_t colon = comment.find(".scene:");
    if (colon == std::string::npos) return;
    const std::size_t begin = comment.find_first_not_of(' ', colon + 7);
    if (begin != std::string::npos) scene_.summary = comment.substr(begin);
    while (!scene_.summary.empty() && static_cast<unsigned char>(scene_.summary.back()) <= ' ') {
      scene_.summary.pop_back();
    }
  }

  void statement() {
    const Token first = now();
    if (first.kind == Token::Kind::kName) {
      using Method = void (Parser::*)();
      static const std::map<std::string, Method> kStatements{
          {"coordinates", &Parser::coordinates},
          {"parameters", &Parser::parameters},
          {"controls", &Parser::controls},
          {"let", &Parser::let},
          {"symmetry", &Parser::symmetry},
          {"period", &Parser::period},
          {"draw", &Parser::draw},
          {"path", &Parser::path},
          {"report", &Parser::report},
          {"name", &Parser::scene_name},
          {"summary", &Parser::scene_summary},
          {"reference", &Parser::scene_reference},
          {"limit", &Parser::limit},
          {"point", &Parser::body_point},
          {"disc", &Parser::disc},
          {"guess", &Parser::guess},
          {"coordinate", &Parser::coordinates},
          {"parameter", &Parser::parameters},
          {"control", &Parser::controls}};
      if (const auto found = kStatements.find(first.text); found != kStatements.end()) {
        ++at_;
        (this->*found->second)();
        expect_line_end();
        return;
      }
      if (after().kind == Token::Kind::kMark && after().text == "=") {
        if (formula(first)) {
          expect_line_end();
          return;
        }
      }
    }
    equation();
    expect_line_end();
  }

  // kinetic = ..., and the like. False where the name is none of them.
  bool formula(const Token& name) {
    const std::map<std::string_view, std::optional<Formula>*> formulas{
        {"kinetic", &scene_.kinetic},
        {"potential", &scene_.potential},
        {"lagrangian", &scene_.lagrangian},
        {"hamiltonian", &scene_.hamiltonian},
        {"cost", &scene_.cost},
        {"chart", &scene_.chart}};
    const std::map<std::string_view, std::optional<MatrixFormula>*> matrices{
        {"mass", &scene_.mass}, {"structure", &scene_.structure}, {"basis", &scene_.basis}};
    if (const auto found = formulas.find(name.text); found != formulas.end()) {
      if (found->second->has_value()) fail(name.place, "'" + name.text + "' is given twice");
      at_ += 2;
      const Expression value = expression();
      *found->second = Formula{value, name.place};
      return true;
    }
    if (names_.count(name.text) != 0 || coordinate(name) >= 0) return false;
    if (const auto found = matrices.find(name.text); found != matrices.end()) {
      if (found->second->has_value()) fail(name.place, "'" + name.text + "' is given twice");
      at_ += 2;
      *found->second = matrix();
      return true;
    }
    std::vector<std::string> words(kKeywords.begin(), kKeywords.end());
    fail(name.place,
         "'" + name.text + "' is not known" + suggestion(name.text, words) + "; accepted: let " +
             name.text + " = ... for a name of your own");
  }

  // a = b: a row, or with controls the velocity of a coordinate.
  void equation() {
    const Place place = now().place;
    const bool is_velocity = now().kind == Token::Kind::kName && coordinate(now()) >= 0 &&
                             after().kind == Token::Kind::kMark && after().text == "'" &&
                             at_ + 2 < tokens_.size() && tokens_[at_ + 2].text == "=";
    if (is_velocity && !scene_.controls.empty()) {
      const int i = coordinate(now());
      at_ += 3;
      scene_.dynamics.resize(scene_.coordinates.size());
      if (scene_.dynamics[i].has_value()) {
        fail(place, "the velocity of " + scene_.coordinates[i].name + " is given twice");
      }
      scene_.dynamics[i] = Formula{expression(), place};
      return;
    }
    const bool statement_like = now().kind == Token::Kind::kName && coordinate(now()) < 0 &&
                                names_.count(now().text) == 0 && !is_function(now().text) &&
                                now().text != "t" && now().text != "pi";
    if (statement_like) {
      std::vector<std::string> words(kKeywords.begin(), kKeywords.end());
      fail(place,
           "'" + now().text + "' begins no statement" + suggestion(now().text, words) +
               "; accepted: coordinates, parameters, controls, let, kinetic, mass, "
               "potential, lagrangian, hamiltonian, structure, cost, an equation, symmetry, "
               "period, limit, point, disc, draw, path, report");
    }
    const Expression left = expression();
    expect("=", "in an equation");
    const Expression right = expression();
    // 0 = g is g, so that multipliers have the sign that one expects.
    scene_.rows.push_back({left.is_zero() ? right : left - right, place});
    if (scene_.rows.size() > kMostItems) fail(place, "there are too many equations");
  }

  static bool is_function(const std::string& name) {
    const auto functions = function_names();
    return std::find(functions.begin(), functions.end(), name) != functions.end();
  }

  std::string unit() {
    if (!take("[")) return "";
    std::string text;
    while (!is_mark("]")) {
      if (now().kind == Token::Kind::kLineEnd || now().kind == Token::Kind::kEnd ||
          now().kind == Token::Kind::kBad || text.size() > 60) {
        unexpected("']' at the end of the unit");
      }
      const bool words =
          !text.empty() && now().kind == Token::Kind::kName && last().kind == Token::Kind::kName;
      text += (words ? " " : "") + now().text;
      ++at_;
    }
    ++at_;
    return text;
  }

  // x, y [length], theta [angle]: a unit is that of the names before it that have none.
  void coordinates() {
    if (!scene_.rows.empty() || scene_.kinetic || scene_.lagrangian || scene_.hamiltonian) {
      fail(last().place, "coordinates come before the formulas");
    }
    std::size_t first = scene_.coordinates.size();
    do {
      const Token name = expect_name("the name of a coordinate");
      if (scene_.coordinates.size() >= kMostCoordinates) {
        fail(name.place,
             "there are too many coordinates; accepted: at most " +
                 std::to_string(kMostCoordinates));
      }
      const int i = scene_.dof();
      define(name, scene_.graph->variable(kConfiguration.first + i));
      scene_.coordinates.push_back({name.text, "", 0});
      if (!is_mark("[")) continue;
      const std::string of = unit();
      for (; first < scene_.coordinates.size(); ++first) {
        const bool angle = of == "angle" || of == "rad";
        scene_.coordinates[first].unit = angle ? "rad" : of;
        if (angle) scene_.coordinates[first].period = 2 * std::numbers::pi;
      }
    } while (take(","));
  }

  void parameters() {
    do {
      const Token name = expect_name("the name of a parameter");
      expect("=", "and the default of the parameter");
      ParameterSource parameter;
      parameter.name = name.text;
      parameter.default_value = constant("the default of " + name.text);
      parameter.unit = unit();
      if (is_mark(">") || is_mark(">=")) {
        parameter.range.open = now().text == ">";
        ++at_;
        parameter.range.lower = constant("the lower bound of " + name.text);
      }
      if (now().kind == Token::Kind::kText) parameter.meaning = tokens_[at_++].text;
      if (!parameter.range.contains(parameter.default_value)) {
        fail(name.place,
             "the default of " + name.text +
                 " is out of its range; accepted: " + parameter.range.text());
      }
      parameter.value = parameter.default_value;
      if (const auto setting = settings_.find(name.text); setting != settings_.end()) {
        parameter.value = setting->second;
        if (!parameter.range.contains(parameter.value)) {
          std::ostringstream what;
          what << "parameter " << name.text << " = " << parameter.value << " must be "
               << parameter.range.text();
          throw std::invalid_argument(what.str());
        }
      }
      define(name, scene_.graph->number(parameter.value));
      scene_.parameters.push_back(std::move(parameter));
    } while (take(","));
  }

  void controls() {
    do {
      const Token name = expect_name("the name of a control");
      const int i = static_cast<int>(scene_.controls.size());
      if (i >= kMostCoordinates) fail(name.place, "there are too many controls");
      define(name, scene_.graph->variable(kAlgebraic.first + i));
      scene_.controls.push_back(name.text);
    } while (take(","));
  }

  void let() {
    const Token name = expect_name("a name");
    expect("=", "after the name");
    const Expression value = expression();
    define(name, value);
  }

  // NAME: y, theta -> -y, -theta
  void symmetry() {
    SymmetrySource symmetry;
    symmetry.place = now().place;
    if (now().kind == Token::Kind::kName && after().kind == Token::Kind::kMark &&
        after().text == ":") {
      at_ += 2;
    }
    do {
      symmetry.coordinates.push_back(expect_coordinate());
    } while (take(","));
    expect("->", "between the coordinates and their images");
    symmetry.images = list();
    if (symmetry.images.size() != symmetry.coordinates.size()) {
      fail(symmetry.place, "as many images as coordinates are needed");
    }
    scene_.symmetries.push_back(std::move(symmetry));
  }

  // period theta = pi, phi = none
  void period() {
    do {
      const int i = expect_coordinate();
      if (!take(":")) expect("=", "and the period");
      if (now().kind == Token::Kind::kName && now().text == "none") {
        ++at_;
        scene_.coordinates[i].period = 0;
        continue;
      }
      const Place place = now().place;
      scene_.coordinates[i].period = constant("the period");
      if (!(scene_.coordinates[i].period > 0)) fail(place, "a period is positive, or none");
    } while (take(","));
  }

  std::vector<Expression> point() {
    const Place place = now().place;
    expect("(", "where a point begins");
    std::vector<Expression> numbers = list();
    expect(")", "at the end of the point");
    if (numbers.size() != 2 && numbers.size() != 3) {
      fail(place, "a point has two or three coordinates");
    }
    for (const Expression& e : numbers) only_configuration(e, place);
    return numbers;
  }

  // What is drawn and reported depends on the configuration alone.
  void only_configuration(const Expression& e, const Place& place) {
    const int after = kConfiguration.first + kConfiguration.count;
    if (scene_.graph->depends(e, kTime.first, 1) ||
        scene_.graph->depends(e, after, kVariables - after)) {
      fail(place, "this may depend on the coordinates only");
    }
  }

  // (x, y) -- (a, b) -- ..., wheel((x, y), heading, radius), box((x, y), heading, length, width)
  void draw() {
    DrawingSource part;
    part.place = now().place;
    if (now().kind == Token::Kind::kName && (now().text == "wheel" || now().text == "box")) {
      const bool wheel = now().text == "wheel";
      part.shape = wheel ? DrawingSource::Shape::kWheel : DrawingSource::Shape::kBox;
      ++at_;
      expect("(", "after the shape");
      part.points.push_back(point());
      const std::size_t wanted = wheel ? 2 : 3;
      while (take(",")) {
        const Place place = now().place;
        part.sizes.push_back(expression());
        only_configuration(part.sizes.back(), place);
      }
      expect(")", "at the end of the shape");
      if (part.sizes.size() != wanted || part.points[0].size() != 2) {
        fail(part.place,
             wheel ? "a wheel is wheel((x, y), heading, radius)"
                   : "a box is box((x, y), heading, length, width)");
      }
    } else {
      do {
        part.points.push_back(point());
        if (part.points.back().size() != part.points.front().size()) {
          fail(part.place, "points of two and of three coordinates in one line");
        }
      } while (take("--"));
      if (part.points.size() < 2) unexpected("'--' and another point");
    }
    if (scene_.drawing.size() >= kMostItems) fail(part.place, "there is too much to draw");
    scene_.drawing.push_back(std::move(part));
  }

  void path() {
    if (scene_.path) fail(last().place, "'path' is given twice");
    scene_.path = point();
  }

  // report hinge [rad] = theta - psi, psi - chi
  void report() {
    const Token name = expect_name("a name for what is reported");
    ReportSource report;
    report.name = name.text;
    report.unit = unit();
    expect("=", "after the name");
    const Place place = now().place;
    do {
      report.values.push_back(expression());
      only_configuration(report.values.back(), place);
      if (report.values.size() > kMostItems) fail(place, "there is too much to report");
    } while (take(","));
    if (report.unit.empty()) report.unit = unit();
    if (report.unit == "angle") report.unit = "rad";
    scene_.reports.push_back(std::move(report));
    if (scene_.reports.size() > kMostItems) fail(place, "there is too much to report");
  }

  // guess u1 = ..., x' = ..., where p_x is the momentum of x: where Newton's method begins.
  void guess() {
    Graph& graph = *scene_.graph;
    knows_momenta_ = true;
    do {
      const Token name = expect_name("a control, or the velocity of a coordinate");
      const auto control = std::find(scene_.controls.begin(), scene_.controls.end(), name.text);
      const int i = coordinate(name);
      Expression of;
      if (control != scene_.controls.end()) {
        of = names_.at(name.text);
      } else if (i >= 0) {
        expect("'", "after a coordinate");
        of = graph.variable(kVelocity.first + i);
      } else {
        fail(name.place, "'" + name.text + "' is neither a control nor a coordinate");
      }
      expect("=", "and the guess");
      scene_.guess.emplace_back(of, Formula{expression(), name.place});
    } while (take(","));
    knows_momenta_ = false;
  }

  // limit -0.6 < phi - theta < 0.6 "steering": one bound or two, with <, <=, > or >=.
  void limit() {
    const Place place = now().place;
    std::vector<Expression> sides{expression()};
    std::vector<bool> rises;
    while (is_mark("<") || is_mark("<=") || is_mark(">") || is_mark(">=")) {
      rises.push_back(now().text[0] == '<');
      ++at_;
      sides.push_back(expression());
    }
    if (rises.empty()) unexpected("'<' or '>' and a bound");
    if (sides.size() > 3) fail(place, "a limit has at most two bounds");
    LimitSource limit;
    limit.place = place;
    limit.lower = -std::numeric_limits<double>::infinity();
    limit.upper = std::numeric_limits<double>::infinity();
    std::size_t middle = sides.size() == 3 || sides[0].is_constant() ? 1 : 0;
    if (sides.size() == 2 && !sides[1 - middle].is_constant()) {  // a < b is b - a > 0
      sides[0] = sides[0] - sides[1];
      sides[1] = scene_.graph->number(0);
    }
    for (std::size_t i = 0; i < sides.size(); ++i) {
      if (i == middle) continue;
      if (!sides[i].is_constant()) fail(place, "a bound is a constant");
      const bool below = (i < middle) == rises[std::min(i, middle)];
      (below ? limit.lower : limit.upper) = sides[i].coefficient;
    }
    if (sides.size() == 3 && rises[0] != rises[1]) fail(place, "both bounds are on one side");
    limit.value = sides[middle];
    only_configuration(limit.value, place);
    if (limit.value.is_constant()) fail(place, "what is limited depends on no coordinate");
    if (!(limit.lower < limit.upper)) fail(place, "the lower bound is not below the upper one");
    const bool named = now().kind == Token::Kind::kText;
    limit.name = named ? tokens_[at_++].text : "limit " + std::to_string(scene_.limits.size() + 1);
    scene_.limits.push_back(std::move(limit));
    if (scene_.limits.size() > kMostItems) fail(place, "there are too many limits");
  }

  // point front = (x, y)
  void body_point() {
    const Token name = expect_name("a name for the point");
    expect("=", "after the name");
    PointSource named{name.text, point()};
    if (named.at.size() != 2) fail(name.place, "a point of the body is in the plane");
    scene_.points.push_back(std::move(named));
    if (scene_.points.size() > kMostItems) fail(name.place, "there are too many points");
  }

  // disc (a, b), r: the named points stay out of it.
  void disc() {
    Disc disc;
    disc.place = now().place;
    disc.centre = point();
    expect(",", "between the centre and the radius");
    disc.radius = constant("the radius");
    const bool fixed =
        disc.centre.size() == 2 && disc.centre[0].is_constant() && disc.centre[1].is_constant();
    if (!fixed || !(disc.radius > 0)) {
      fail(disc.place, "a disc is (a, b), r with constants and r > 0");
    }
    discs_.push_back(std::move(disc));
    if (discs_.size() > kMostItems) fail(discs_.back().place, "there are too many discs");
  }

  // The distance of every point from every disc, as (d^2 - r^2) / (2 r): it has the same bound and
  // the same slope there, and is smooth everywhere.
  void add_discs() {
    std::vector<PointSource> points = scene_.points;
    if (!discs_.empty() && points.empty()) {
      const int x = numbered("x");
      const int y = numbered("y");
      if (x < 0 || y < 0)
        fail(discs_[0].place, "a disc needs points; accepted: point NAME = (.., ..)");
      Graph& graph = *scene_.graph;
      points.push_back(
          {"(x, y)",
           {graph.variable(kConfiguration.first + x), graph.variable(kConfiguration.first + y)}});
    }
    int number = 0;
    for (const Disc& disc : discs_) {
      ++number;
      for (const PointSource& of : points) {
        const Expression dx = of.at[0] - disc.centre[0];
        const Expression dy = of.at[1] - disc.centre[1];
        const Expression square = dx * dx + dy * dy;
        LimitSource limit;
        limit.name = "disc " + std::to_string(number) + ", " + of.name;
        limit.value = 0.5 / disc.radius * square;
        limit.lower = 0.5 * disc.radius;
        limit.upper = std::numeric_limits<double>::infinity();
        limit.place = disc.place;
        limit.disc = {disc.centre[0].coefficient, disc.centre[1].coefficient, disc.radius};
        scene_.limits.push_back(std::move(limit));
      }
    }
  }

  // The rest of the line, in quotes or as it is.
  std::string text() {
    if (now().kind == Token::Kind::kText) return tokens_[at_++].text;
    unexpected("a text in quotes");
  }
  void scene_name() {
    if (now().kind == Token::Kind::kName) {
      scene_.name = tokens_[at_++].text;
      while (take("-")) scene_.name += "-" + expect_name("the rest of the name").text;
    } else {
      scene_.name = text();
    }
  }
  void scene_summary() { scene_.summary = text(); }
  void scene_reference() { scene_.reference = text(); }

  struct Disc {
    std::vector<Expression> centre;
    double radius = 0;
    Place place;
  };

  std::string_view text_;
  const std::string& file_;
  const ParameterSettings& settings_;
  SceneSource scene_;
  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  int nesting_ = 0;
  bool knows_momenta_ = false;
  std::map<std::string, Expression> names_;
  std::vector<Disc> discs_;
};

}  // namespace

void refuse_text(std::string_view text,
                 const std::string& file,
                 const Place& place,
                 const std::string& what) {
  std::ostringstream message;
  message << file << ":" << place.line << ":" << place.column << ": " << what;
  const std::string line = line_of(text, place.line);
  if (!line.empty()) {
    message << "\n  " << line << "\n  "
            << std::string(static_cast<std::size_t>(std::max(place.column - 1, 0)), ' ') << "^";
  }
  throw TextError(message.str(), place);
}

SceneSource read_scene(std::string_view text,
                       const std::string& name,
                       const std::string& file,
                       const ParameterSettings& settings) {
  return Parser(text, name, file, settings).run();
}

}  // namespace carnot::language
