// SPDX-License-Identifier: MIT
/// A fluid without a fluid, which looks whether a solid program keeps to the protocol. On several
/// ranks it is cut in x; each rank judges what it gets, and all of them what they have together.
///
/// The box is 1 × 1 m, the interval ten solid steps of 1 ms. What particles there are is offered as
/// particle1_x, _y, _vx, _vy, _id, _interval (of its insertion) and _until (of its removal, or -1).
#pragma once

#include <mpi.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocol/wire/ball_union.h"
#include "protocol/wire/channel.h"
#include "protocol/wire/session.h"

namespace conformance {

inline constexpr double kInterval = 1e-2;  ///< [s]
inline constexpr double kRadius = 0.05;    ///< [m]

/// What an engine has done wrong.
struct Wrong : std::runtime_error {
  using std::runtime_error::runtime_error;
};
void expect(bool good, const std::string& what);
void expect_near(double value, double exact, double tolerance, const std::string& what);

/// Does what is no more than the way to a check: whatever ends it is the engine's mistake.
template <class Way>
void expect_passes(Way&& way) {
  try {
    way();
  } catch (const protocol::ProtocolError& error) {
    throw Wrong(error.what());
  }
}

/// Of two discs, x, y and radius about its centre [m].
inline constexpr double kClump[2][3] = {{-0.03, 0.0, kRadius}, {0.03, 0.0, kRadius}};

/// A disc, and from when until when it is in the box.
struct Start {
  double x, y, vx = 0.0, vy = 0.0;
  int interval = 0, until = -1, id = 0;  ///< id 0: its number in the list
};

/// What the scene of a check is.
struct Scene {
  std::vector<Start> discs{{0.3, 0.5}};
  bool clumps = false;  ///< of each disc a clump, see kClump
  bool periodic = false;
  double density = 1000.0;  ///< [kg/m³]
  double depth = 1.0;       ///< [m]
  double timeout = 0.0;     ///< that is offered to the engine [s]; 0: the judge's own patience
  double mass() const;      ///< of a disc [kg]
  double inertia() const { return 0.5 * mass() * kRadius * kRadius; }
  protocol::UnionMoments clump() const;  ///< what the discs of a clump fill together
};

class Judge {
 public:
  /// @param folder    for what the engine writes
  /// @param patience  how long the engine may take for an answer [s]
  Judge(protocol::Channel& channel, MPI_Comm local, std::string folder, double patience);

  /// The handshake for a scene, and the part of it of this rank.
  protocol::Hello hello(const Scene& scene) const;
  protocol::Hello part(const protocol::Hello& whole) const;

  using Loads = std::function<protocol::Load(int interval, const protocol::Particle&)>;
  using Look = std::function<void(int interval, const std::vector<protocol::Particle>&)>;
  /// Agrees; intervals with loads of the caller's choice, of which each rank that a particle
  /// touches sends an equal part; `look` sees all particles of each, by id. Ends with the engine's
  /// last states.
  /// @param flag_at_two  sent with the loads of interval 2
  void converse(const protocol::Hello& hello, int intervals, const Loads& load, const Look& look,
                std::uint32_t flag_at_two = protocol::kContinue);

  /// Agrees and answers loads of zero until the states of an interval have come.
  void converse_until(const protocol::Hello& hello, int interval);

  /// Every rank of the engine must say it within 0.3 of the patience.
  void expect_farewell(const std::string& after) const;

  /// Called before the loads of an interval are answered, e.g. to be slow.
  std::function<void(int interval)> before_answer = [](int) {};

  protocol::Channel& channel() const { return channel_; }
  int rank() const { return rank_; }
  double patience() const { return patience_; }
  /// For a complaint that the engine should have at once [s].
  double short_patience() const { return 0.4 * patience_; }

 private:
  std::vector<protocol::Particle> together(const std::vector<protocol::Particle>& mine) const;
  int sharing(const protocol::Particle& particle) const;

  protocol::Channel& channel_;
  MPI_Comm local_;
  std::string folder_;
  double patience_;
  int rank_ = 0, ranks_ = 1;
  std::vector<protocol::Hello> parts_;  // [fluid rank], of the scene in progress
};

/// No load.
protocol::Load nothing(int interval, const protocol::Particle& p);
/// A force and a torque that grow from interval to interval.
protocol::Load pushed(int interval, const protocol::Particle& p);

}  // namespace conformance
