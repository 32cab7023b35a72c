// A directory per test, and trajectories made by hand: plots need no numerics.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "carnot/plots/figure.h"

namespace carnot::plots {

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Fresh and empty; removed afterwards.
class Directory : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            ("carnot it's " + std::string(test->name()));  // a name that a shell could misread
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  void TearDown() override { std::filesystem::remove_all(path_); }

  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] std::ptrdiff_t entries() const {
    return std::distance(std::filesystem::directory_iterator(path_), {});
  }

  std::filesystem::path path_;
};

// A rod with a wheel at each end, in the plane of its first two coordinates.
inline SceneInfo plane_scene() {
  SceneInfo info;
  info.name = "two_wheels";
  info.configuration = {{"x", "length", 0}, {"y", "length", 0}, {"theta", "rad", 6.28}};
  info.drawing.view = Drawing::View::kPlane;
  info.drawing.body = [](const double* q) {
    const double c = std::cos(q[2]);
    const double s = std::sin(q[2]);
    using Role = Polyline::Role;
    return std::vector<Polyline>{
        {Role::kBody, {{q[0] - c, q[1] - s}, {q[0], q[1]}}},
        {Role::kWheel, {{q[0] - 1.1 * c, q[1] - 1.1 * s}, {q[0] - 0.9 * c, q[1] - 0.9 * s}}},
        {Role::kWheel, {{q[0] - 0.1 * c, q[1] - 0.1 * s}, {q[0] + 0.1 * c, q[1] + 0.1 * s}}}};
  };
  info.extremes = {{"largest_turn", "rad", [](const double* q) { return q[2]; }}};
  return info;
}

inline SceneInfo scene_of(Drawing::View view) {
  SceneInfo info = plane_scene();
  info.drawing.view = view;
  if (view != Drawing::View::kPlane) info.drawing.body = nullptr;
  return info;
}

// A curve through the origin, moved by `offset` and `scale`d; with two multipliers.
inline Trajectory wave(std::size_t rows, double offset = 0, double scale = 1) {
  Trajectory trajectory;
  for (std::size_t i = 0; i < rows; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(rows);
    const double x = offset + scale * t;
    trajectory.t.push_back(t);
    trajectory.q.push_back({x, offset + scale * std::sin(3 * t), std::cos(3 * t)});
    trajectory.p.push_back({1, t, -t});
    trajectory.lambda.push_back({t, t * t});
    trajectory.hamiltonian.push_back(1 + 1e-15 * static_cast<double>(i % 3));
  }
  return trajectory;
}

inline Curve curve_of(const Trajectory& trajectory) {
  return {"", &trajectory, 1.5, 2.5, {{"largest_turn", 0.5}}};
}

// Writes the figure and fails if gnuplot or anyone else says a word.
inline void draw_silently(const std::string& file,
                          const SceneInfo& info,
                          const std::vector<Curve>& curves,
                          Figure figure = Figure::kAutomatic) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  EXPECT_EQ(write_figure(file, info, curves, figure), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(contents(file).size(), 500U) << file;
}

}  // namespace carnot::plots
