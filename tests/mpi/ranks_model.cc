// Ranks that sleep instead of solving: how many of them one journal serves (docs/clusters.md).
// usage: mpirun -n RANKS ranks_model JOURNAL CHUNKS SECONDS BYTES
// Rank 0 only serves here, so that what is measured is its work for the others.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "atlas/chunk_list.h"
#include "atlas/ranks.h"

namespace {

using namespace carnot::apps;
using Clock = std::chrono::steady_clock;

void lead(Ranks& ranks, const char* path, long chunks, double seconds) {
  Journal journal(path, {{{"model", "sleep"}}, {}, {}}, false);
  ChunkList list(journal, chunks);
  (void)ranks.agree(1);
  const auto began = Clock::now();
  std::chrono::duration<double> busy{0};
  ranks.serve({[&] { return list.next(); },
               [&](long chunk, std::string_view text) {
                 const auto begin = Clock::now();
                 journal.append(chunk, text);
                 busy += Clock::now() - begin;
               },
               [] { return true; }});
  const std::chrono::duration<double> wall = Clock::now() - began;
  journal.remove();
  const int others = ranks.size() - 1;
  const double ideal = static_cast<double>(chunks) * seconds / others;
  std::printf("ranks %d chunk %.4g s: wall %.4g s, efficiency %.3f, journal %.1f us a chunk\n",
              others,
              seconds,
              wall.count(),
              ideal / wall.count(),
              1e6 * busy.count() / static_cast<double>(chunks));
}

void follow(Ranks& ranks, double seconds, std::size_t bytes) {
  (void)ranks.agree(0);
  const std::string record(bytes, 'x');
  for (long chunk = ranks.ask(); chunk >= 0; chunk = ranks.ask()) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    ranks.hand_in(chunk, record);
  }
  ranks.leave();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  Ranks ranks;
  const double seconds = std::atof(argv[3]);
  if (ranks.leads()) {
    lead(ranks, argv[1], std::atol(argv[2]), seconds);
  } else {
    follow(ranks, seconds, static_cast<std::size_t>(std::atol(argv[4])));
  }
}
