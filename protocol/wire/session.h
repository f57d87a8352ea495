// SPDX-License-Identifier: MIT
/// The order of messages, from both sides. Any number of ranks a side; no collectives.
///
///   fluid rank                                solid rank
///   handshake      ──── to every rank ────►   takes the offered variables, runs its script
///   checks         ◄─── handshake ────────
///   Answer         ◄──────────────────────►   Answer           (every reason of both, to both)
///   advances       ◄─── States(k) ────────    x, v, ω at t_k
///   Loads(k)       ────────────────────────►  substeps to t_{k+1}
///   …                                          …
///   does not move  ◄─── States(n) | last ──   or Goodbye at any k
#pragma once

#include <map>
#include <span>
#include <unordered_map>
#include <vector>

#include "protocol/wire/arrival_check.h"
#include "protocol/wire/channel.h"

namespace protocol {

/// What the solid side sent for one interval, merged over its ranks and ordered by id.
struct Arrival {
  StepHeader head;
  std::vector<Particle> particles;
  std::optional<std::string> goodbye;  ///< the solid left in good order; no particles then
  std::optional<SolidReport> report;   ///< summed over the solid's ranks
};

class FluidSession {
 public:
  /// Sends `hello` to every solid rank. `channel` must outlive the session.
  /// @param timeout  longest wait for the partner [s]
  FluidSession(Channel& channel, Hello hello, double timeout);

  /// Waits for the solid's handshake and settles. @return that of solid rank 0
  /// @throws Refusal, PeerFault, Timeout, BadMessage
  const Hello& agree();

  /// Waits for the states of the next interval, and holds them against what was agreed.
  /// @throws BadMessage  wrong interval, unknown shape, double id, what ArrivalCheck refuses
  const Arrival& receive();

  /// Answers the last arrival.
  /// @param loads  one each of its particles, in their order
  /// @throws ProtocolError  they are not; BadMessage  one is not finite
  void answer(std::span<const Load> loads, std::uint32_t flags = kContinue);

  double waited() const { return waited_; }  ///< seconds spent in waits so far

 private:
  std::vector<std::int64_t> learn_shapes(const std::vector<StateBatch>& batches);
  void merge(const std::vector<StateBatch>& batches);
  void merge_reports(const std::vector<StateBatch>& batches);
  bool merge_as_before(const std::vector<StateBatch>& batches);
  void merge_anew(const std::vector<StateBatch>& batches);
  void check_states(std::span<const Particle> before, std::span<const std::int64_t> told);

  Channel& channel_;
  Hello mine_, partner_;
  ArrivalCheck check_;
  ClumpCheck clumps_;
  double lightest_ = 1.0;  // mass of the particles [kg]
  double timeout_, waited_ = 0.0;
  std::int64_t next_interval_;
  std::unordered_map<std::int64_t, Shape> shapes_;
  Arrival arrival_;
  std::vector<std::int64_t> ids_;                  // of its particles
  std::vector<std::vector<std::size_t>> order_;    // [solid rank][record] -> index in arrival_
  std::vector<std::vector<std::int64_t>> before_;  // [solid rank] ids of the interval before
};

class SolidSession {
 public:
  /// Waits for the handshake of every fluid rank. `channel` must outlive the session.
  /// @param timeout  longest wait [s]; the fluid's `coupling_timeout` where it offers one
  SolidSession(Channel& channel, double timeout);

  /// Handshake of fluid rank 0; its variables are for the script.
  const Hello& fluid() const { return fluid_.front(); }

  double timeout() const { return timeout_; }
  void set_timeout(double seconds) { timeout_ = seconds; }
  /// What the solid computes with now, for the next states; until then what its handshake said.
  void set(const Setting& now) { setting_ = now; }
  /// Goes on over another channel to the same partner, e.g. a recording one.
  void use(Channel& channel) { channel_ = &channel; }

  /// Sends `hello`, settles. @throws Refusal, PeerFault, Timeout, BadMessage
  void agree(const Hello& hello);

  struct Reply {
    std::uint32_t flags = kContinue;
    std::span<const Load> loads;  ///< in the order of the states sent; valid until the next are
  };
  /// Sends this rank's states.
  /// @throws ProtocolError  a particle is as far outside of the box as that is long
  /// @param states, shapes  one each a particle, same order
  /// @param report  what this rank has to say of itself
  void send(const StepHeader& head, std::span<const State> states, std::span<const Shape> shapes,
            const std::optional<SolidReport>& report = {});
  /// Waits for the loads of the states sent last, summed over fluid ranks in rank order; a particle
  /// that touches no fluid has none.
  Reply collect();
  /// Both, one after the other, as the serial schedule has it. With kLast nothing is waited for.
  Reply exchange(const StepHeader& head, std::span<const State> states,
                 std::span<const Shape> shapes, const std::optional<SolidReport>& report = {});

  /// Leaves in good order instead of the next states.
  void goodbye(const std::string& reason);

  double waited() const { return waited_; }

 private:
  void send_states(int rank, const StepHeader& head, std::span<const State> states,
                   std::span<const Shape> shapes, const std::optional<SolidReport>& report);
  std::uint32_t add_loads(int rank);

  Channel* channel_;
  double timeout_, waited_ = 0.0;
  std::vector<Hello> fluid_;                    // [fluid rank]
  std::vector<std::vector<Shape>> told_;        // [fluid rank] shapes sent last
  std::vector<std::vector<std::size_t>> sent_;  // [fluid rank] states it got
  Setting setting_;
  StepHeader head_;  // of the states sent last
  std::vector<Load> loads_;
};

}  // namespace protocol
