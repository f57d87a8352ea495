// SPDX-License-Identifier: GPL-2.0-or-later
/// A scene as its author wrote it: plain data in SI units. `io/scene_reader` fills it,
/// `solver/plan` turns it into numbers for the lattice.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lbm_solver/base/fluid_scene.h"
#include "lbm_solver/base/numerics_scene.h"
#include "lbm_solver/base/output_scene.h"
#include "lbm_solver/base/solids_scene.h"
#include "lbm_solver/base/units.h"

namespace lbm {

enum class SideKind { Wall, Periodic };

struct BoxScene {
  int dimension = 2;
  Vec3 size;           ///< [m]; z in three dimensions only
  Vec3 origin;         ///< lower corner [m]
  double depth = 1.0;  ///< of the layer in two dimensions [m]
  std::array<SideKind, 3> sides{SideKind::Wall, SideKind::Wall, SideKind::Wall};
  Vec3 pressure_jump;  ///< across periodic sides, low minus high [Pa]
};

struct Scene {
  std::string file;  ///< where it was read
  std::string title;
  /// Every key by its full name, e.g. fluid.density or boundary.1.velocity, with its value, those
  /// too that defaults have filled in.
  std::map<std::string, std::string> settings;
  BoxScene box;
  FluidScene fluid;
  NumericsScene numerics;
  std::optional<ParticleScene> particles;
  std::optional<CouplingScene> coupling;  ///< absent: a fluid alone
  double end_time = 0.0;                  ///< [s]
  double checkpoint_every = 0.0;          ///< [s]; 0: never
  double steady_below = 0.0;              ///< end earlier where the velocity changes less; 0: never
  std::vector<BoundaryScene> boundaries;
  std::vector<ObstacleScene> obstacles;
  InitialScene initial;
  OutputScene output;
};

}  // namespace lbm
