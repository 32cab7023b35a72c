// Places in space as a mesh measures them: the coordinates that are seen, each 1 wide.
#pragma once

#include <utility>
#include <vector>

namespace carnot::internal {

class ImageScale {
 public:
  // Of no size yet.
  explicit ImageScale(std::vector<int> seen) : seen_(std::move(seen)) {}

  // Takes the sizes from these places of n coordinates each, of which some may be NaN.
  void measure(const std::vector<double>& ends, int n);
  [[nodiscard]] bool is_measured() const { return !sizes_.empty(); }
  // Of one place.
  [[nodiscard]] std::vector<double> image(const double* q) const;

 private:
  std::vector<int> seen_;
  std::vector<double> sizes_;
};

}  // namespace carnot::internal
