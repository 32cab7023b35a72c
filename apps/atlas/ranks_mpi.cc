// The processes that mpirun or srun started, by MPI.
#include <mpi.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "atlas/ranks.h"
#include "carnot/numerics/parallel.h"
#include "text/launcher.h"

namespace carnot::apps {
namespace {

enum Tag : int { kAsk = 1, kChunk, kResult, kLeave };

// Between two looks for a message: to wait inside of MPI would keep a core busy that has problems
// to solve. So do looks that are frequent: with 0.2 ms between them two ranks on two cores took 10
// per cent more time than two threads, with up to 1 ms they take 2 per cent more. Where messages
// come soon after each other, looks do, too: an eighth of the time apart that has gone by since the
// last one.
class Patience {
 public:
  void sleep() const {
    using std::chrono::microseconds;
    constexpr microseconds kShortest{50};
    constexpr microseconds kLongest{1000};
    constexpr int kPart = 8;
    const auto waited = std::chrono::duration_cast<microseconds>(Clock::now() - begin_);
    std::this_thread::sleep_for(std::clamp(waited / kPart, kShortest, kLongest));
  }
  void begin() { begin_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace

class Ranks::Implementation {
 public:
  Implementation() {
    int given = 0;
    // The threads of a rank take turns, see mutex_.
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &given);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    MPI_Comm local = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &local);
    MPI_Comm_size(local, &neighbours_);
    MPI_Comm_free(&local);
  }
  ~Implementation() { MPI_Finalize(); }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] int neighbours() const { return neighbours_; }

  long agree(long of_rank_0) {
    MPI_Bcast(&of_rank_0, 1, MPI_LONG, 0, MPI_COMM_WORLD);
    return of_rank_0;
  }

  std::vector<std::string> exchange(const std::string& own) {
    auto size = static_cast<std::int64_t>(own.size());
    std::vector<std::int64_t> sizes(size_);
    MPI_Allgather(&size, 1, MPI_INT64_T, sizes.data(), 1, MPI_INT64_T, MPI_COMM_WORLD);
    std::vector<std::string> all(size_);
    for (int rank = 0; rank < size_; ++rank) {
      std::string& text = all[rank];
      text.resize(sizes[rank]);
      if (rank == rank_) text = own;
      // MPI counts by int.
      constexpr std::int64_t kMost = 1 << 30;
      for (std::int64_t at = 0; at < sizes[rank]; at += kMost) {
        const auto part = static_cast<int>(std::min(kMost, sizes[rank] - at));
        MPI_Bcast(text.data() + at, part, MPI_BYTE, rank, MPI_COMM_WORLD);
      }
    }
    return all;
  }

  void serve(const Desk& desk) {
    std::exception_ptr error;
    bool open = true;
    int present = size_ - 1;
    Patience patience;
    while (present > 0) {
      int waiting = 0;
      MPI_Status status;
      MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &waiting, &status);
      open = open && desk.goes_on();
      if (waiting == 0) {
        patience.sleep();
        continue;
      }
      patience.begin();
      try {
        present -= answer(status, desk, open && !error) ? 0 : 1;
      } catch (...) {
        if (!error) error = std::current_exception();
      }
    }
    if (error) std::rethrow_exception(error);
  }

  long ask() {
    const std::lock_guard lock(mutex_);
    std::int64_t chunk = -1;
    MPI_Send(nullptr, 0, MPI_BYTE, 0, kAsk, MPI_COMM_WORLD);
    const Patience patience;
    for (int waiting = 0; waiting == 0;) {
      MPI_Iprobe(0, kChunk, MPI_COMM_WORLD, &waiting, MPI_STATUS_IGNORE);
      if (waiting == 0) patience.sleep();
    }
    MPI_Recv(&chunk, 1, MPI_INT64_T, 0, kChunk, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return static_cast<long>(chunk);
  }

  void hand_in(std::int64_t chunk, std::string_view text) {
    std::string message(sizeof chunk, '\0');
    std::memcpy(message.data(), &chunk, sizeof chunk);
    message += text;
    const std::lock_guard lock(mutex_);
    MPI_Send(
        message.data(), static_cast<int>(message.size()), MPI_BYTE, 0, kResult, MPI_COMM_WORLD);
  }

  void leave() { MPI_Send(nullptr, 0, MPI_BYTE, 0, kLeave, MPI_COMM_WORLD); }

 private:
  // One message. False when its sender leaves.
  static bool answer(const MPI_Status& message, const Desk& desk, bool open) {
    int size = 0;
    MPI_Get_count(&message, MPI_BYTE, &size);
    std::string text(static_cast<std::size_t>(size), '\0');
    MPI_Recv(text.data(),
             size,
             MPI_BYTE,
             message.MPI_SOURCE,
             message.MPI_TAG,
             MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    if (message.MPI_TAG == kLeave) return false;
    if (message.MPI_TAG == kAsk) {
      const std::int64_t chunk = open ? desk.next() : -1;
      MPI_Send(&chunk, 1, MPI_INT64_T, message.MPI_SOURCE, kChunk, MPI_COMM_WORLD);
      return true;
    }
    std::int64_t chunk = 0;
    std::memcpy(&chunk, text.data(), sizeof chunk);
    desk.take(static_cast<long>(chunk), std::string_view(text).substr(sizeof chunk));
    return true;
  }

  std::mutex mutex_;
  int rank_ = 0;
  int size_ = 1;
  int neighbours_ = 1;  // ranks of this machine, this one among them
};

Ranks::Ranks() : own_(launched_rank() >= 0 ? std::make_unique<Implementation>() : nullptr) {}
Ranks::~Ranks() = default;

int Ranks::size() const { return own_ ? own_->size() : 1; }
int Ranks::rank() const { return own_ ? own_->rank() : 0; }
int Ranks::threads() const {
  return std::max(1, thread_count(0) / (own_ ? own_->neighbours() : 1));
}
long Ranks::agree(long of_rank_0) { return own_ ? own_->agree(of_rank_0) : of_rank_0; }
std::vector<std::string> Ranks::exchange(const std::string& own) {
  return own_ ? own_->exchange(own) : std::vector{own};
}
void Ranks::abandon() {
  if (size() > 1) MPI_Abort(MPI_COMM_WORLD, 1);
}
void Ranks::serve(const Desk& desk) {
  if (own_) own_->serve(desk);
}
long Ranks::ask() { return own_->ask(); }
void Ranks::hand_in(long chunk, std::string_view text) { own_->hand_in(chunk, text); }
void Ranks::leave() { own_->leave(); }

}  // namespace carnot::apps
