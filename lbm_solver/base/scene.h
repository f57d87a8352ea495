// SPDX-License-Identifier: GPL-2.0-or-later
/// A scene as its author wrote it: plain data in SI units. `io/scene_reader` fills it,
/// `solver/plan` turns it into numbers for the lattice.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lbm_solver/base/units.h"
#include "protocol/messages.h"

namespace lbm {

using protocol::Range;

enum class SideKind { Wall, Periodic };

struct BoxScene {
  Vec2 size{0.0, 0.0};    ///< [m]
  Vec2 origin{0.0, 0.0};  ///< lower corner [m]
  double depth = 1.0;     ///< [m]
  SideKind x = SideKind::Wall, y = SideKind::Wall;
};

struct FluidScene {
  double density = 1000.0;    ///< [kg/m^3]
  double viscosity = 1e-6;    ///< kinematic [m^2/s]
  Vec2 gravity{0.0, 0.0};     ///< [m/s^2]
  double velocity_scale = 0;  ///< largest expected speed of fluid or particles [m/s]
};

struct NumericsScene {
  std::optional<double> cell;                ///< [m]
  std::optional<double> cells_per_diameter;  ///< instead of `cell`: of the smallest particle
  std::optional<double> time_step;           ///< fluid step [s]; absent: chosen by rule
  std::string collision = "trt";
  double magic = 3.0 / 16.0;  ///< Λ of TRT
};

struct ParticleScene {
  Range diameter;           ///< [m]
  Range density;            ///< [kg/m^3]
  std::vector<Vec2> start;  ///< centres [m], offered to the script as particle_x …
  std::optional<double> contact_stiffness;       ///< [N/m]; bounds the solid's step
  std::map<std::string, std::string> variables;  ///< further names for the script
};

struct CouplingScene {
  std::string solid_term = "layered_holdych";
  int fluid_steps = 1;          ///< a coupling interval
  std::optional<int> substeps;  ///< solid steps a coupling interval; absent: from the stiffness
  bool inner_inertia = true;    ///< correct for the inertia of the fluid inside a particle
  protocol::Buoyancy buoyancy = protocol::Buoyancy::ByFluid;
  double timeout = 300.0;  ///< longest wait for the solid [s]
};

struct OutputScene {
  double fields_every = 0.0;  ///< [s]; 0: none
  double probe_every = 0.0;   ///< [s]; 0: every interval
};

struct Scene {
  std::string file;  ///< where it was read
  std::string title;
  BoxScene box;
  FluidScene fluid;
  NumericsScene numerics;
  std::optional<ParticleScene> particles;
  std::optional<CouplingScene> coupling;  ///< absent: a fluid alone
  double end_time = 0.0;                  ///< [s]
  OutputScene output;
};

}  // namespace lbm
