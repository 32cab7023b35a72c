#include "carnot/plots/series_plot.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <regex>
#include <stdexcept>

#include "plot_fixtures.h"

namespace carnot::plots::series_plot_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using SeriesFile = Directory;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A page of one panel with one series.
SeriesPage page_of(const std::vector<double>& x, const std::vector<double>& y) {
  SeriesPage page;
  page.title = "title of the page";
  SeriesPanel panel;
  panel.x.label = "x [length]";
  panel.y.label = "y [energy]";
  Series series;
  series.title = "series";
  series.x = x;
  series.y = y;
  panel.series = {series};
  page.panels = {panel};
  return page;
}

SeriesPage logarithmic(SeriesPage page, bool x, bool y) {
  page.panels.front().x.logarithmic = x;
  page.panels.front().y.logarithmic = y;
  return page;
}

std::string commands(const SeriesPage& page) { return series_picture(page).commands; }

// "set xrange [lower:upper]".
Interval range_of(const std::string& commands, const std::string& letter) {
  std::smatch match;
  const std::regex range("set " + letter + R"(range \[([^:]+):([^\]]+)\])");
  if (!std::regex_search(commands, match, range)) return {};
  return {std::stod(match[1]), std::stod(match[2])};
}

void draw_silently(const std::string& file, const SeriesPage& page) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  EXPECT_EQ(write_series(file, page), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(contents(file).size(), 500U) << file;
}

TEST_F(SeriesFile, NamesWhatItShows) {
  SeriesPage page = page_of({1, 2, 3}, {1, 4, 9});
  page.subtitle = "below the title";
  page.panels.front().title = "of the panel";
  page.panels.front().slopes = {{"line to compare", 1, 1, 1, 2}};
  page.panels.front().notes = {{2, 4, "a note"}};
  draw_silently(file("a.svg"), page);
  const std::string svg = contents(file("a.svg"));
  for (const std::string text : {"title of the page",
                                 "below the title",
                                 "of the panel",
                                 "x [length]",
                                 "y [energy]",
                                 "series",
                                 "line to compare",
                                 "a note"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(entries(), 1);
}

TEST_F(SeriesFile, EveryEndingAndMarkWorks) {
  SeriesPage page = page_of({1, 2, 3}, {1, 4, 9});
  auto& series = page.panels.front().series;
  for (const Series::Mark mark :
       {Series::Mark::kPoints, Series::Mark::kLineAndPoints, Series::Mark::kDots}) {
    series.push_back(series.front());
    series.back().mark = mark;
    series.back().dashed = true;
  }
  for (const std::string ending : {"png", "svg", "pdf", "gif"}) {
    draw_silently(file("a." + ending), page);
  }
  EXPECT_EQ(entries(), 4);
}

TEST_F(SeriesFile, EveryLegendAndScaleIsDrawn) {
  const SeriesPage page = page_of({0.1, 1, 10, 100}, {1e-3, 1, 2, 1e5});
  SeriesPage all = page;
  all.panels.clear();
  for (const Legend legend : {Legend::kRight,
                              Legend::kTopLeft,
                              Legend::kTopRight,
                              Legend::kBottomLeft,
                              Legend::kBottomRight}) {
    for (const bool x : {false, true}) {
      for (const bool y : {false, true}) {
        all.panels.push_back(logarithmic(page, x, y).panels.front());
        all.panels.back().legend = legend;
      }
    }
  }
  draw_silently(file("a.svg"), all);
}

TEST_F(SeriesFile, ValuesThatCannotBeDrawnAreLeftOut) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::vector<std::vector<double>> cases{{},
                                               {0},
                                               {-1, -2},
                                               {kNan, kNan},
                                               {3},
                                               {3, 3},
                                               {1e-300, 1e300},
                                               {1e-99, 1e99},
                                               {kNan, -1, 0, 1e-300, 1, 1e200, kInfinity, 2}};
  for (const bool x : {false, true}) {
    for (const bool y : {false, true}) {
      SCOPED_TRACE(2 * static_cast<int>(x) + static_cast<int>(y));
      for (const auto& values : cases) {
        draw_silently(file("a.svg"), logarithmic(page_of(values, values), x, y));
      }
    }
  }
}

TEST_F(SeriesFile, BadInputIsRefused) {
  const SeriesPage good = page_of({1, 2}, {1, 2});
  EXPECT_THROW(write_series(file("a.bmp"), good), std::invalid_argument);
  EXPECT_THROW(write_series(file("a.svg"), SeriesPage{}), std::invalid_argument);
  SeriesPage none = good;
  none.columns = 0;
  EXPECT_THROW(write_series(file("a.svg"), none), std::invalid_argument);
  try {
    write_series(file("a.svg"), page_of({1, 2}, {1}));
    ADD_FAILURE();
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()), "series 'series' has 2 x and 1 y");
  }
  EXPECT_EQ(entries(), 0);
}

TEST(SeriesScale, ManyDecadesHavePowersOfTen) {
  const std::string text = commands(logarithmic(page_of({1, 2}, {1e-12, 1}), false, true));
  EXPECT_THAT(text, AllOf(HasSubstr("set logscale y"), HasSubstr("set format y '10^{%T}'")));
  EXPECT_THAT(text, Not(HasSubstr("set logscale x")));
  const Interval range = range_of(text, "y");
  EXPECT_LT(range.lower, 1e-12);
  EXPECT_GT(range.upper, 1);
}

TEST(SeriesScale, FewDecadesHaveNumbersBetween) {
  const std::string text = commands(logarithmic(page_of({0.03, 0.4}, {1, 2}), true, false));
  EXPECT_THAT(text,
              HasSubstr("set xtics ('' 0.03 1, '' 0.04 1, 0.05, '' 0.06 1, '' 0.07 1, "
                        "'' 0.08 1, '' 0.09 1, 0.1, 0.2, '' 0.3 1, '' 0.4 1)"));
}

TEST(SeriesScale, AGivenRangeIsKept) {
  SeriesPage page = page_of({0, 5}, {0, 1});
  page.panels.front().x.range = {-1, 2};
  const Interval range = range_of(commands(page), "x");
  EXPECT_EQ(range.lower, -1);
  EXPECT_EQ(range.upper, 2);
}

TEST(SeriesScale, EqualAxesHaveOneScale) {
  for (const double wide : {0.1, 1.0, 30.0}) {
    SeriesPage page = page_of({0, wide}, {0, 1});
    page.panels.front().equal_axes = true;
    page.width = 500;
    page.height = 300;
    const std::string text = commands(page);
    EXPECT_NEAR(range_of(text, "x").span() / range_of(text, "y").span(), 500.0 / 300, 1e-9);
    EXPECT_GE(range_of(text, "x").span(), wide);
    EXPECT_GE(range_of(text, "y").span(), 1);
  }
}

// What is drawn of a line of slope `s` from (1, 2) to x = 10.
std::string line_data(bool log_x, bool log_y, double s) {
  SeriesPage page = logarithmic(page_of({1, 10}, {1, 100}), log_x, log_y);
  page.panels.front().slopes = {{"", s, 1, 2, 10}};
  return commands(page);
}

TEST(SeriesSlope, IsThatOfTheDrawnScales) {
  EXPECT_THAT(line_data(false, false, 3), HasSubstr("\n1 2\n10 29\n"));
  EXPECT_THAT(line_data(true, true, 2), HasSubstr("\n1 2\n10 200\n"));
  EXPECT_THAT(line_data(true, false, 5), HasSubstr("\n1 2\n10 7\n"));
  EXPECT_THAT(line_data(false, true, std::log(10.0) / 9), HasSubstr("\n1 2\n10 20\n"));
}

TEST(SeriesPageTest, HoldsItsPanelsInRows) {
  SeriesPage page = page_of({1, 2}, {1, 2});
  const Picture one = series_picture(page);
  page.panels.resize(5, page.panels.front());
  page.columns = 2;
  const Picture five = series_picture(page);
  EXPECT_GT(five.width, 1.9 * (one.width - 30));
  EXPECT_LT(five.width, 2 * one.width);
  EXPECT_GT(five.height, 2.5 * one.height);
  EXPECT_LT(five.height, 3 * one.height);
}

TEST(SeriesPageTest, LongSeriesAreThinned) {
  std::vector<double> x;
  for (int i = 0; i < 100000; ++i) x.push_back(i);
  EXPECT_LT(commands(page_of(x, x)).size(), 100000U);
}

TEST(SeriesPageTest, WithoutAFrameThereAreNoTics) {
  SeriesPage page = page_of({1, 2}, {1, 2});
  page.panels.front().frame = false;
  EXPECT_THAT(commands(page), AllOf(HasSubstr("unset tics"), HasSubstr("unset border")));
}

}  // namespace
}  // namespace carnot::plots::series_plot_test
