// SPDX-License-Identifier: MIT
/// Waiting for another program by asking again and again, fast on cores of one's own, and without
/// taking those of others.
#ifndef BPLBM_PROTOCOL_POLLING_H
#define BPLBM_PROTOCOL_POLLING_H

#include <sched.h>
#include <time.h>

#include <chrono>
#include <thread>

#include "protocol/program/watch.h"

namespace protocol {

/// Whether others compute on the core on which this thread waits. From one of its turns to the next
/// it then lacks milliseconds, which no interrupt takes.
///
/// It matters a great deal: who polls uses up its share of the core, and where it must not miss a
/// message stands at the end of the queue. Who sleeps gets the core at once when it wakes.
class Crowd {
 public:
  /// @throws nothing. One call of the system; a look takes half a microsecond.
  bool here() const { return elapsed() - (computed() - computed_at_begin_) > kTurn; }

  /// Waits that follow one in a crowd are in it as well, whatever they wait for: they sleep without
  /// waiting for the proof.
  static constexpr int kLasts = 100;
  /// How many of this thread still do.
  static int& lasts() {
    static thread_local int waits = 0;
    return waits;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr double kTurn = 1e-3;  // [s], of Linux on two cores at least .75 ms

  double elapsed() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }
  static double computed() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }

  Clock::time_point begin_ = Clock::now();
  double computed_at_begin_ = computed();
};

/// Polls until `ready` or until the time is over. A short busy wait keeps the latency of a ready
/// partner; afterwards the core is offered to others at every turn, because the partner may need
/// it. In a crowd the wait sleeps between its turns. (MPI may offer the core at every turn as well:
/// a few of them can take as long as a time-out.)
template <class Ready>
bool poll(double seconds, Ready&& ready) {
  constexpr int busy_turns = 2000, turns_a_look = 8;
  constexpr auto nap = std::chrono::microseconds(20);
  using Clock = std::chrono::steady_clock;
  const Waiting here("an exchange");
  for (int turn = 0; turn < turns_a_look; ++turn)  // most waits end here
    if (ready()) return true;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  const Crowd crowd;
  int& crowded_waits = Crowd::lasts();
  if (crowded_waits > 0) --crowded_waits;
  for (int turn = turns_a_look; Clock::now() < end; ++turn) {
    if (ready()) return true;
    const bool busy = turn < busy_turns;
    if (crowded_waits == 0 && (!busy || turn % turns_a_look == 0) && crowd.here())
      crowded_waits = Crowd::kLasts;
    if (crowded_waits > 0)
      std::this_thread::sleep_for(nap);
    else if (!busy)
      sched_yield();
  }
  return ready();
}

}  // namespace protocol

#endif
