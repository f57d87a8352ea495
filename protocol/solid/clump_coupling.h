// SPDX-License-Identifier: MIT
/// Clumps on the solid's side: rigid bodies of several spheres, of which one rank of the engine
/// answers for each, while the spheres may be spread over all of them.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "protocol/wire/messages.h"
#include "protocol/wire/overlap.h"

namespace protocol {

/// A clump, as the rank knows it that answers for it.
struct EngineClump {
  std::int64_t id = 0;  ///< of the carrier; no particle has it, nor is it kItself
  std::int64_t type = 1;
  Vec3 x{}, v{}, omega{};  ///< of its centre
  double mass = 0.0;
  double inertia = 0.0;  ///< a third of the trace of its tensor, in two dimensions about z
  double volume = 0.0;   ///< that it displaces; 0: the union of its spheres is measured
  /// How many spheres it has. One that lacks some has begun to leave the box, and is not sent.
  int spheres = 0;
};

/// When loads are added to clumps.
enum class Moment {
  SetUp,  ///< of a run: to the forces that act in its first half-step
  Step,   ///< to the forces of the step that is computed
  End     ///< of a step: to the forces that are still there and act in the next first half-step
};

/// A sphere of a clump, on the rank that holds it.
struct EngineSphere {
  std::int64_t id = 0, carrier = 0, type = 1;
  double radius = 0.0;
  Vec3 x{}, v{}, omega{};
};

/// Brings clumps and their spheres together, and keeps the loads that come for clumps.
class ClumpCoupling {
 public:
  /// What `send` appends to this rank's states.
  struct Records {
    std::vector<State>& states;
    std::vector<Shape>& shapes;
  };
  /// This rank's clumps with all their spheres, each clump before them. Collective.
  /// @param box  its corners, periodic axes, dimension and depth
  void gather(MPI_Comm comm, const Hello& box, std::span<const EngineClump> mine,
              std::span<const EngineSphere> spheres, const Records& records);

  /// Takes over loads of this rank's clumps, so that every rank has those of all. Collective.
  /// @return what has changed
  std::vector<Load> take(MPI_Comm comm, std::span<const Load> mine);

  /// Of all clumps, as they came last.
  std::span<const Load> loads() const { return loads_; }
  /// Those of a restart file.
  void set_loads(std::vector<Load> loads) { loads_ = std::move(loads); }

 private:
  /// What is found out once of a clump: the same in every later interval.
  struct Known {
    double radius = 0.0, volume = 0.0;
  };
  Known measure(const Hello& box, const EngineClump& clump, std::span<const EngineSphere> spheres);

  std::unordered_map<std::int64_t, Known> known_;
  std::vector<Load> loads_;
};

}  // namespace protocol
