// One process: a build without MPI.
#include <cassert>

#include "atlas/ranks.h"
#include "carnot/numerics/parallel.h"

namespace carnot::apps {

class Ranks::Implementation {};

Ranks::Ranks() = default;
Ranks::~Ranks() = default;

int Ranks::size() const { return 1; }
int Ranks::rank() const { return 0; }
int Ranks::threads() const { return thread_count(0); }
long Ranks::agree(long of_rank_0) { return of_rank_0; }
std::vector<std::string> Ranks::exchange(const std::string& own) { return {own}; }
void Ranks::abandon() {}
void Ranks::serve(const Desk& /*desk*/) {}
long Ranks::ask() { return -1; }
void Ranks::hand_in(long /*chunk*/, std::string_view /*text*/) { assert(false); }
void Ranks::leave() {}

}  // namespace carnot::apps
