// From expressions to steps. Each node that is used becomes one result or, where it is a product of
// a sum that nobody else needs, a part of the fused multiplications of that sum.
#include "carnot/language/tape.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <memory>
#include <unordered_map>
#include <utility>

#include "carnot/language/tape_machine.h"

namespace carnot::language {

// An operand before slots are known: a constant, or the number of a result.
struct TapeValue {
  int result = -1;  // negative: a constant
  double constant = 0;
};

class TapeBuilder {
 public:
  TapeBuilder(Graph& graph, Tape& tape) : graph_(graph), tape_(tape) {}

  void build(std::span<const Block> inputs,
             std::span<const Expression> outputs,
             std::span<const int> output_groups) {
    for (const Expression& e : outputs) count_uses(e.node);
    find_variables();
    std::vector<int> results;
    results.reserve(outputs.size());
    for (const Expression& e : outputs) results.push_back(in_memory(operand(e)));
    assign_slots(results);
    connect(inputs, results, output_groups);
  }

 private:
  using Value = TapeValue;
  struct Draft {
    TapeOperation operation;
    Operation function;
    std::array<Value, 3> operands;
    int result;
    int second = -1;
    int index = 0;
  };

  void count_uses(std::uint32_t root) {
    std::vector<std::uint32_t> open{root};
    while (!open.empty()) {
      const std::uint32_t id = open.back();
      open.pop_back();
      if (uses_[id]++ > 0) continue;
      const Node& node = graph_.node(id);
      for (const Part& part : node.parts) {
        open.push_back(part.node);
        if (node.operation == Operation::kProduct && part.factor < 0) ++reciprocals_[part.node];
      }
      if (node.operation == Operation::kSin || node.operation == Operation::kCos) {
        const auto key = std::pair(node.parts[0].node, node.parts[0].factor);
        (node.operation == Operation::kSin ? sines_ : cosines_)[key] = id;
      }
    }
  }

  // In the order of the groups, so that neighbours in memory have neighbouring slots.
  void find_variables() {
    std::map<std::uint32_t, std::uint32_t> nodes;
    for (const auto& [id, uses] : uses_) {
      const Node& node = graph_.node(id);
      if (node.operation == Operation::kVariable) nodes[node.index] = id;
    }
    for (const auto& [variable, id] : nodes) {
      variables_.emplace_back(static_cast<int>(variable), results_);
      values_.emplace(id, Value{results_++, 0});
    }
  }

  Value emit(TapeOperation operation,
             const Value& a,
             const Value& b = {},
             const Value& c = {},
             Operation function = Operation::kOne) {
    drafts_.push_back({operation, function, {a, b, c}, results_++});
    return {drafts_.back().result, 0};
  }
  static Value constant(double x) { return {-1, x}; }

  Value operand(const Expression& e) {
    if (e.is_constant()) return constant(e.coefficient);
    if (e.coefficient == 1) return value(e.node);
    const auto key = std::pair(e.node, e.coefficient);
    if (const auto known = scaled_.find(key); known != scaled_.end()) return known->second;
    const Value result = emit(TapeOperation::kMultiply, value(e.node), constant(e.coefficient));
    scaled_.emplace(key, result);
    return result;
  }
  Value operand(const Part& part) { return operand(Expression{&graph_, part.factor, part.node}); }

  // Constants have no slot of their own unless they are wanted.
  int in_memory(const Value& x) {
    if (x.result >= 0) return x.result;
    const auto [place, is_new] = constants_.try_emplace(x.constant, 0);
    if (is_new) place->second = emit(TapeOperation::kCopy, x).result;
    return place->second;
  }

  Value value(std::uint32_t id) {
    if (const auto known = values_.find(id); known != values_.end()) return known->second;
    const Node& node = graph_.node(id);
    Value result;
    switch (node.operation) {
      case Operation::kOne:
      case Operation::kVariable:  // known already
        result = constant(1);
        break;
      case Operation::kSum:
        result = sum(node);
        break;
      case Operation::kProduct:
        result = product(node);
        break;
      case Operation::kSin:
      case Operation::kCos:
        result = circular(node);
        break;
      case Operation::kWhole:
        result = operand(node.parts[0]);
        break;
      case Operation::kSqrt:
        result = emit(TapeOperation::kSqrt, operand(node.parts[0]));
        break;
      case Operation::kAtan2: {
        const Value y = operand(node.parts[0]);
        const Value x = operand(node.parts[1]);
        result = emit(TapeOperation::kAtan2, y, x);
        break;
      }
      default:
        result = emit(TapeOperation::kFunction, operand(node.parts[0]), {}, {}, node.operation);
        drafts_.back().index = static_cast<int>(node.index);
    }
    values_.emplace(id, result);
    return result;
  }

  // Where both the sine and the cosine of an angle are wanted, they are found together.
  Value circular(const Node& node) {
    const auto key = std::pair(node.parts[0].node, node.parts[0].factor);
    const auto sine = sines_.find(key);
    const auto cosine = cosines_.find(key);
    const Value angle = operand(node.parts[0]);
    const bool is_sine = node.operation == Operation::kSin;
    if (sine == sines_.end() || cosine == cosines_.end()) {
      return emit(is_sine ? TapeOperation::kSin : TapeOperation::kCos, angle);
    }
    const Value s = emit(TapeOperation::kSinCos, angle);
    const Value c{results_++, 0};
    drafts_.back().second = c.result;
    values_.emplace(is_sine ? cosine->second : sine->second, is_sine ? c : s);
    return is_sine ? s : c;
  }

  // node^exponent for a whole exponent > 0.
  Value power(std::uint32_t id, int exponent) {
    if (exponent == 1) return value(id);
    const auto key = std::pair(id, exponent);
    if (const auto known = powers_.find(key); known != powers_.end()) return known->second;
    const Value half = power(id, exponent / 2);
    Value result = emit(TapeOperation::kMultiply, half, half);
    if (exponent % 2 == 1) result = emit(TapeOperation::kMultiply, result, value(id));
    powers_.emplace(key, result);
    return result;
  }

  Value reciprocal(std::uint32_t id) {
    if (const auto known = inverses_.find(id); known != inverses_.end()) return known->second;
    const Value result = emit(TapeOperation::kDivide, constant(1), value(id));
    inverses_.emplace(id, result);
    return result;
  }

  // The factors of a product; its last divisor apart, where its reciprocal serves nothing else.
  std::vector<Value> factors(const Node& node, std::vector<Value>& divisors) {
    std::vector<Value> result;
    for (const Part& part : node.parts) {
      const int exponent = static_cast<int>(part.factor);
      if (exponent > 0) {
        result.push_back(power(part.node, exponent));
      } else if (exponent == -1 && reciprocals_[part.node] == 1) {
        divisors.push_back(value(part.node));
      } else {
        const Value inverse = reciprocal(part.node);
        for (int i = 0; i < -exponent; ++i) result.push_back(inverse);
      }
    }
    return result;
  }

  // All but the last factor multiplied with each other and with `coefficient`; `last` may be empty.
  Value multiply(const std::vector<Value>& parts, std::size_t count, double coefficient) {
    Value result = parts[0];
    for (std::size_t i = 1; i < count; ++i) {
      result = emit(TapeOperation::kMultiply, result, parts[i]);
    }
    if (coefficient != 1) result = emit(TapeOperation::kMultiply, result, constant(coefficient));
    return result;
  }

  Value product(const Node& node) {
    std::vector<Value> divisors;
    const std::vector<Value> parts = factors(node, divisors);
    Value result = parts.empty() ? constant(1) : multiply(parts, parts.size(), 1);
    for (const Value& divisor : divisors) result = emit(TapeOperation::kDivide, result, divisor);
    return result;
  }

  // A term of a sum: coefficient x a, or coefficient x a b.
  struct Term {
    double coefficient;
    Value a;
    std::vector<Value> parts{};  // two or more: the product of them stands for a
  };

  // Operands first, then the sum in one go, so that its running value stays in the register.
  Value sum(const Node& node) {
    std::vector<Term> terms;
    for (const Part& part : node.parts) {
      const Node& inner = graph_.node(part.node);
      const bool fuse = inner.operation == Operation::kProduct && uses_[part.node] == 1 &&
                        values_.find(part.node) == values_.end();
      Term term{part.factor, {}, {}};
      std::vector<Value> divisors;
      if (fuse) term.parts = factors(inner, divisors);
      for (const Value& divisor : divisors) {
        term.parts.push_back(emit(TapeOperation::kDivide, constant(1), divisor));
      }
      if (term.parts.size() < 2) {
        term.a = fuse ? term.parts[0] : value(part.node);
        term.parts.clear();
      }
      terms.push_back(std::move(term));
    }
    for (Term& term : terms) {
      const double size = std::abs(term.coefficient);
      if (term.parts.size() > 2 || (term.parts.size() == 2 && size != 1)) {
        const Value head = multiply(term.parts, term.parts.size() - 1, size);
        term.parts = {head, term.parts.back()};
        term.coefficient /= size;
      }
    }
    // A constant or a term without a sign begins; else the sign costs one operation.
    Value running = constant(node.constant);
    auto first = terms.end();
    if (node.constant == 0) {
      first = std::find_if(
          terms.begin(), terms.end(), [](const Term& t) { return t.coefficient == 1; });
      if (first == terms.end()) first = terms.begin();
      if (!first->parts.empty()) {
        running = emit(TapeOperation::kMultiply, first->parts[0], first->parts[1]);
        if (first->coefficient != 1) {
          running = emit(TapeOperation::kMultiply, running, constant(first->coefficient));
        }
      } else if (first->coefficient == 1) {
        running = first->a;
      } else {
        running = emit(TapeOperation::kMultiply, first->a, constant(first->coefficient));
      }
    }
    for (auto term = terms.begin(); term != terms.end(); ++term) {
      if (term == first) continue;
      const bool minus = term->coefficient < 0;
      const double size = std::abs(term->coefficient);
      if (!term->parts.empty()) {
        running = emit(minus ? TapeOperation::kNegated : TapeOperation::kFused,
                       term->parts[0],
                       term->parts[1],
                       running);
      } else if (size == 1) {
        running = emit(minus ? TapeOperation::kSubtract : TapeOperation::kAdd, running, term->a);
      } else {
        running = emit(minus ? TapeOperation::kNegated : TapeOperation::kFused,
                       term->a,
                       constant(size),
                       running);
      }
    }
    return running;
  }

  // Results that are needed later than in the next step get a slot, which is free again after their
  // last use.
  void assign_slots(std::span<const int> outputs) {
    const int count = static_cast<int>(drafts_.size());
    std::vector<int> last(results_, -1);  // the step of the last use
    std::vector<int> made(results_, -1);  // the step whose result it is; -1: an input
    std::vector<bool> second(results_, false);
    for (int i = 0; i < count; ++i) {
      made[drafts_[i].result] = i;
      if (drafts_[i].second >= 0) {
        made[drafts_[i].second] = i;
        second[drafts_[i].second] = true;
      }
      for (const Value& x : drafts_[i].operands) {
        if (x.result >= 0) last[x.result] = i;
      }
    }
    for (const int result : outputs) last[result] = count;
    const auto in_register = [&](int result, int step) {
      return made[result] == step - 1 && made[result] >= 0 && !second[result];
    };
    std::vector<bool> stored(results_, false);
    for (int i = 0; i < count; ++i) {
      for (const Value& x : drafts_[i].operands) {
        if (x.result >= 0 && !in_register(x.result, i)) stored[x.result] = true;
      }
      if (drafts_[i].second >= 0) stored[drafts_[i].second] = true;
    }
    for (const int result : outputs) stored[result] = true;

    slot_.assign(results_, 0);
    std::vector<std::uint32_t> free;
    std::vector<std::vector<int>> ends(count + 1);
    const auto take = [&](int result) {
      if (free.empty()) {
        slot_[result] = static_cast<std::uint32_t>(tape_.slots_++);
      } else {
        slot_[result] = free.back();
        free.pop_back();
      }
      if (last[result] < count) ends[std::max(last[result], 0)].push_back(result);
    };
    for (const auto& [variable, result] : variables_) take(result);
    for (int i = 0; i < count; ++i) {
      const Draft& draft = drafts_[i];
      TapeStep step;
      step.operation = draft.operation;
      step.function = draft.function;
      step.index = draft.index;
      const auto place = [&](const Value& x) {
        TapeOperand operand;
        if (x.result < 0) {
          operand.constant = x.constant;
        } else if (in_register(x.result, i)) {
          operand.where = TapeOperand::Where::kResult;
        } else {
          operand.where = TapeOperand::Where::kSlot;
          operand.slot = slot_[x.result];
        }
        return operand;
      };
      step.a = place(draft.operands[0]);
      step.b = place(draft.operands[1]);
      step.c = place(draft.operands[2]);
      // The second result is written before the first operand is read for the last time.
      if (draft.second >= 0) take(draft.second);
      for (const int result : ends[i]) {
        if (stored[result] && made[result] != i) free.push_back(slot_[result]);
      }
      step.stored = stored[draft.result];
      if (step.stored) {
        take(draft.result);
        step.to = slot_[draft.result];
      }
      if (draft.second >= 0) {
        step.second = slot_[draft.second];
        if (last[draft.second] < 0) free.push_back(slot_[draft.second]);
      }
      tape_.steps_.push_back(step);
    }
  }

  void connect(std::span<const Block> inputs,
               std::span<const int> results,
               std::span<const int> output_groups) {
    for (const auto& [variable, result] : variables_) {
      const auto of = std::find_if(inputs.begin(), inputs.end(), [v = variable](const Block& b) {
        return b.first <= v && v < b.first + b.count;
      });
      assert(of != inputs.end());
      const auto group = static_cast<std::uint32_t>(of - inputs.begin());
      const auto row = static_cast<std::uint32_t>(variable - of->first);
      if (!tape_.in_.empty()) {
        TapeRows& last = tape_.in_.back();
        if (last.group == group && last.row + last.count == row) {
          ++last.count;
          continue;
        }
      }
      tape_.in_.push_back({group, row, slot_[result], 1});
    }
    std::size_t next = 0;
    for (const int count : output_groups) {
      auto& group = tape_.out_.emplace_back();
      for (int row = 0; row < count; ++row) group.push_back(slot_[results[next++]]);
    }
    assert(next == results.size());
  }

  Graph& graph_;
  Tape& tape_;
  std::unordered_map<std::uint32_t, int> uses_;
  std::unordered_map<std::uint32_t, int> reciprocals_;
  std::map<std::pair<std::uint32_t, double>, std::uint32_t> sines_;
  std::map<std::pair<std::uint32_t, double>, std::uint32_t> cosines_;
  std::unordered_map<std::uint32_t, Value> values_;
  std::map<std::pair<std::uint32_t, double>, Value> scaled_;
  std::map<std::pair<std::uint32_t, int>, Value> powers_;
  std::unordered_map<std::uint32_t, Value> inverses_;
  std::map<double, int> constants_;
  std::vector<std::pair<int, int>> variables_;  // of the graph, and the result that it is
  std::vector<Draft> drafts_;
  std::vector<std::uint32_t> slot_;
  int results_ = 0;
};

std::byte* tape_memory(std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  thread_local std::vector<std::byte> memory;
  if (memory.size() < bytes + kLine) memory.resize(bytes + kLine);
  void* address = memory.data();
  std::size_t space = memory.size();
  return static_cast<std::byte*>(std::align(kLine, bytes, address, space));
}

Tape::Tape(Graph& graph,
           std::span<const Block> inputs,
           std::span<const Expression> outputs,
           std::span<const int> output_groups) {
  TapeBuilder(graph, *this).build(inputs, outputs, output_groups);
  single_ = TapeMachine<double>::bind(*this);
  wide_ = TapeMachine<WideNumber>::bind(*this);
  native_ = std::make_shared<NativeTape>();
}

bool Tape::run(std::span<const double* const> in, std::span<double* const> out) const {
  using Machine = TapeMachine<double>;
  return Machine::run<1>(
      *this, [&](std::byte* memory) { Machine::execute(single_.data(), memory); }, in, out);
}

bool Tape::run_rows_at_length(std::span<const double* const> in,
                              std::span<double* const> out) const {
  if (const NativeTape::Code code = native_->make({steps_, in_, out_, slots_})) {
    return code(in.data(), out.data(), tape_memory(native_->bytes()));
  }
  using Machine = TapeMachine<WideNumber>;
  return Machine::run<kTapeLanes>(
      *this, [&](std::byte* memory) { Machine::execute(wide_.data(), memory); }, in, out);
}

}  // namespace carnot::language
