#include "carnot/shooting/field/field_partners.h"

#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace carnot::internal {

void FieldPartners::share(const std::function<void(ByteWriter&)>& write,
                          const std::function<void(ByteReader&)>& read) {
  ++shared_;
  if (alone()) {
    stopped_ = stops_;
    return;
  }
  std::ostringstream own;
  ByteWriter out(own);
  out.add(shared_);
  out.add(stops_.load());
  write(out);
  out.finish();
  const std::vector<std::string> all = team_.exchange(own.str());
  for (int rank = 0; rank < team_.size; ++rank) {
    std::istringstream text(all[rank]);
    ByteReader in(text);
    if (in.take<std::uint64_t>() != shared_) {
      throw std::runtime_error(
          "the processes of a field have come to different decisions; are their processors of one "
          "kind?");
    }
    if (in.take<bool>()) stopped_ = true;
    if (rank == team_.rank) continue;
    read(in);
    in.finish();
  }
  if (stopped_) stops_ = true;
}

}  // namespace carnot::internal
