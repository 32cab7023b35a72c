// Fields that go on from what an interrupted one has kept.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "carnot/shooting/solve_field.h"
#include "shooting/field_axis.h"
#include "shooting/problems.h"

namespace carnot::field_state_test {
namespace {

using test::axis;

// Vehicles are promised less in vain, and some are beyond jumps: each part of the work is done.
Field vehicles(const FieldOptions& options) {
  return solve_field(
      test::vehicle({0, 0, 0, 0}, {0, 0, 0, 0}),
      {axis(0, -0.4, 0.4, 3), axis(1, -0.4, 0.4, 3), axis(2, -1, 0.5, 5), axis(3, -1, 0.5, 5)},
      options);
}

FieldOptions quick() {
  FieldOptions options;
  options.check = 4;
  return options;
}

class FieldState : public ::testing::Test {
 protected:
  void SetUp() override {
    FieldOptions options = quick();
    options.keep = [this](const auto& write) {
      std::ostringstream text;
      write(text);
      states_.push_back(text.str());
    };
    whole_ = vehicles(options);
    ASSERT_TRUE(whole_.finished);
    ASSERT_GT(states_.size(), 8U);
  }
  static Field from(const std::string& state) {
    std::istringstream text(state);
    FieldOptions options = quick();
    options.state = &text;
    return vehicles(options);
  }

  Field whole_;
  std::vector<std::string> states_;
};

TEST_F(FieldState, LeadsToTheSameField) {
  for (std::size_t k = 0; k < states_.size(); k += states_.size() / 5) {
    const Field field = from(states_[k]);
    EXPECT_GT(field.resumed, 0);
    EXPECT_EQ(field.action, whole_.action);
    EXPECT_EQ(field.p0, whole_.p0);
    EXPECT_EQ(field.error, whole_.error);
    EXPECT_EQ(field.label, whole_.label);
    EXPECT_EQ(field.searches, whole_.searches);
    EXPECT_EQ(field.pushes, whole_.pushes);
    EXPECT_EQ(field.sweeps, whole_.sweeps);
    EXPECT_EQ(field.checked, whole_.checked);
  }
}

TEST_F(FieldState, OfAWholeFieldNeedsNoSearches) {
  std::istringstream text(states_.back());
  FieldOptions options = quick();
  options.state = &text;
  int kept = 0;
  options.keep = [&kept](const auto&) { ++kept; };
  EXPECT_EQ(vehicles(options).action, whole_.action);
  EXPECT_EQ(kept, 0);
}

TEST_F(FieldState, IsRefusedWhereItIsDamaged) {
  const std::string& state = states_.back();
  EXPECT_THROW(from(""), DamagedState);
  EXPECT_THROW(from(state.substr(0, state.size() / 2)), DamagedState);
  EXPECT_THROW(from(state.substr(0, state.size() - 1)), DamagedState);
  for (std::size_t i = 3; i < state.size(); i += state.size() / 40) {
    std::string flipped = state;
    flipped[i] = static_cast<char>(flipped[i] ^ 4);
    EXPECT_THROW(from(flipped), DamagedState) << i;
  }
}

TEST_F(FieldState, IsThatOfOneField) {
  FieldOptions other_seed = quick();
  other_seed.search.seed = 1;
  FieldOptions other_size = quick();
  other_size.branches = 2;
  for (FieldOptions options : {other_seed, other_size}) {
    std::istringstream text(states_.back());
    options.state = &text;
    EXPECT_THROW(vehicles(options), DamagedState);
  }
}

}  // namespace
}  // namespace carnot::field_state_test
