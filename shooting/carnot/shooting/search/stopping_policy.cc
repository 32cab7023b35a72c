#include "carnot/shooting/search/stopping_policy.h"

#include <algorithm>

namespace carnot::internal {
namespace {

constexpr int kRound = 8;  // starts between two looks at the list
constexpr int kMinStarts = 16;
constexpr int kMinNear = 24;    // by the ways to a near target
constexpr int kMinEasy = 12;    // where most of them agree
constexpr int kMaxStarts = 96;  // when the best extremal keeps changing
constexpr int kMaxStartsAll = 240;
constexpr int kMaxBlocked = 2;           // times the limit: starts that do not count
constexpr int kSweeps = 24;              // rounds of near hits, where more than the best is wanted
constexpr int kEnoughHits = 3;           // of the least action
constexpr int kConvergedPerRival = 8;    // there may be another rival where there is one
constexpr double kMostConverged = 0.75;  // share of the starts of an easy problem that converge
constexpr double kMostHits = 0.6;        // and that hit the least action

}  // namespace

StoppingPolicy::StoppingPolicy(const GeodesicOptions& options, bool by_paths, bool near)
    : wants_more_(options.all || options.count > 1),
      all_(options.all),
      count_(static_cast<std::size_t>(options.count)),
      given_(options.starts > 0),
      near_(near),
      limit_(given_ ? options.starts
             : all_ ? kMaxStartsAll
                    : kMaxStarts),
      sweeps_(by_paths && wants_more_ && !given_ ? kSweeps : 0) {}

int StoppingPolicy::left(const SearchTally& tally) const {
  const int in_vain = given_ ? 0 : std::min(tally.blocked, kMaxBlocked * limit_);
  return limit_ + in_vain - tally.drawn;
}

int StoppingPolicy::round(const SearchTally& tally) const {
  const bool nearly = !wants_more_ && 0 < tally.starts && tally.starts < kMinStarts;
  return std::min(nearly ? kRound / 2 : kRound, left(tally));
}

double StoppingPolicy::share(const SearchTally& tally) const {
  const double share = static_cast<double>(tally.drawn) / (tally.drawn + left(tally));
  return sweeps_ > 0 ? 0.5 * share : share;
}

bool StoppingPolicy::may_end(const SearchTally& tally) const {
  if (given_ || tally.starts < (near_ ? kMinNear : kMinEasy)) return false;
  if (tally.starts >= kMinStarts) return true;
  return !wants_more_ && tally.converged >= kMostConverged * tally.starts;
}

bool StoppingPolicy::ends(const SearchTally& tally, const Competition& competition) const {
  const bool clear = competition.rivals <= 1 && competition.hits >= kMostHits * tally.starts;
  if (tally.starts < kMinStarts && !clear) return false;
  return competition.hits >= kEnoughHits &&
         tally.converged >= kConvergedPerRival * competition.rivals;
}

}  // namespace carnot::internal
