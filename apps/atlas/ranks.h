// The processes of one call: one, or those that mpirun or srun started.
//
// Rank 0 keeps the journal and hands out chunks. The other ranks ask for one, send back what they
// found, and ask again, so that the quick ones get more. An exchange is two short messages and the
// text of a record; nobody waits for anybody else. When a rank dies, MPI ends all of them, and the
// journal holds what had reached rank 0.
//
// A field is made by all of them in step: each tells all others what it has done (exchange).
//
// A build without MPI, and a call that nothing launched, has rank 0 alone.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace carnot::apps {

// What rank 0 does for the others.
struct Desk {
  std::function<long()> next;                                   // a chunk to work on, -1: none left
  std::function<void(long chunk, std::string_view text)> take;  // what was found
  std::function<bool()> goes_on;  // asked often; once false, no chunk is handed out any more
};

class Ranks {
 public:
  // Begins MPI where this process was launched as one of several. All of them must come here.
  Ranks();
  // Waits for the others.
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  [[nodiscard]] int size() const;
  [[nodiscard]] int rank() const;
  [[nodiscard]] bool leads() const { return rank() == 0; }
  // How many threads of its own a rank has where nothing is said: the cores of a machine are shared
  // by its ranks.
  [[nodiscard]] int threads() const;
  // What rank 0 says, for all of them. Each must ask.
  [[nodiscard]] long agree(long of_rank_0);
  // What each of them says, in their order. Each must ask, from one thread.
  [[nodiscard]] std::vector<std::string> exchange(const std::string& own);
  // Ends all of them with exit status 1, where this is not the only one: the others wait for what
  // this one cannot do any more.
  void abandon();

  // Rank 0, from one thread: serves the others until all have left. What the desk throws is thrown
  // then.
  void serve(const Desk& desk);

  // The other ranks, from any thread: a chunk, or -1.
  long ask();
  void hand_in(long chunk, std::string_view text);
  // Once, when this rank asks no more.
  void leave();

 private:
  class Implementation;
  std::unique_ptr<Implementation> own_;
};

}  // namespace carnot::apps
