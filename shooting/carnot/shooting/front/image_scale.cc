#include "carnot/shooting/front/image_scale.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace carnot::internal {

void ImageScale::measure(const std::vector<double>& ends, int n) {
  sizes_.clear();
  for (const int j : seen_) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t i = j; i < ends.size(); i += n) {
      if (!std::isfinite(ends[i])) continue;
      low = std::min(low, ends[i]);
      high = std::max(high, ends[i]);
    }
    sizes_.push_back(high > low ? high - low : 0);
  }
  // A surface that is thin in one direction is not to be magnified there.
  constexpr double kThin = 1e-3;
  const double largest = *std::max_element(sizes_.begin(), sizes_.end());
  for (double& size : sizes_) size = std::max({size, kThin * largest, 1e-300});
}

std::vector<double> ImageScale::image(const double* q) const {
  std::vector<double> image;
  for (std::size_t k = 0; k < seen_.size(); ++k) image.push_back(q[seen_[k]] / sizes_[k]);
  return image;
}

}  // namespace carnot::internal
