// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lbm_solver/base/scene.h"
#include "lbm_solver/solver/block_loads.h"
#include "lbm_solver/solver/fluid.h"

namespace lbm {

/// What binds the fluid step: the scene gives it; Mach's number; τ ≤ 1.5; a pressure difference.
enum class StepBound { Given, Speed, Relaxation, Pressure };

/// A scene turned into numbers: grid, steps, and the dimensionless groups that judge them.
struct Plan {
  Domain domain;
  Units units;
  KernelChoice kernel;
  std::int64_t intervals = 0;  ///< coupling intervals (fluid steps when alone) to the end time
  int fluid_steps = 1;         ///< a coupling interval
  int substeps = 1;            ///< solid steps a coupling interval

  double wished_step = 0.0;      ///< dt before it was fitted to the end time [s]
  double lattice_speed = 0.0;    ///< C = dx/dt [m/s]
  double u_over_c = 0.0;         ///< velocity scale / C, the papers' Mach number
  double reynolds = 0.0;         ///< u L/nu
  double reynolds_length = 0.0;  ///< its L: smallest particle, first disc at rest, or the box [m]
  std::string reynolds_of;       ///< what L is of
  double reynolds_cell = 0.0;    ///< Re_h = u dx / nu
  double cells_per_diameter = 0.0;  ///< smallest particle; 0 without particles
  SolidScheme scheme = SolidScheme::ImmersedMovingBoundary;
  std::string solid_reason;      ///< what auto took for solids and why; empty where given
  std::string collision_reason;  ///< why auto took what it took; empty where it was given
  StepBound step_bound = StepBound::Given;
  std::string step_limit;      ///< the same in words
  std::string substep_limit;   ///< what chose the substeps
  std::string expected_error;  ///< of the drag on bodies; empty where there are none
  std::vector<std::string> warnings;

  double interval() const { return units.dt * fluid_steps; }  ///< [s]
};

/// Speed limits, as velocity over C = dx/dt.
inline constexpr double kWarnSpeed = 0.1;
inline constexpr double kStopSpeed = 0.2;

/// Volume of a particle [m^3]; in two dimensions of a disc as thick as the layer.
double particle_volume(const Scene& scene, double diameter);

/// C = dx/dt that keeps Mach's number, τ and the change of density small [m/s], and which of them
/// binds, also in words.
struct StepChoice {
  double lattice_speed;
  StepBound bound;
  const char* words;
};
StepChoice choose_step(const Scene& scene, double dx, double viscosity);

/// Chooses what the scene leaves open and refuses what cannot work.
/// Step rule: C = max(10 velocity_scale, √(3 Δp/(rho 0.03)), 3 nu/dx); the last keeps tau <= 1.5.
/// Collision "auto": TRT with covered cells by resistance while Re_h <= 5, central moments with
/// Noble–Torczynski above.
/// @param step  of the run that it goes on from [s]: a restart keeps it, whatever its end time;
/// else
///              it is rounded down so that the end time is a whole number of intervals
/// @throws InputError
Plan make_plan(const Scene& scene, std::optional<double> step = std::nullopt);

/// A fluid as a scene wants it: boundaries and obstacles in place, initial state set.
Fluid make_fluid(const Scene& scene, const Plan& plan, const Decomposition& ranks);
inline Fluid make_fluid(const Scene& scene, const Plan& plan) {
  return make_fluid(scene, plan, Decomposition(plan.domain));
}

inline constexpr double kDrumWall = 10.0;  ///< cells that the wall of a drum is thick

/// A motion's pose when a fluid step begins, in lattice units.
Pose pose_in_cells(const Units& units, const MotionScene& motion, std::int64_t step);

/// The scene's obstacles that are discs or spheres, in lattice units, ids -1, -2, … as they are
/// when a fluid step begins.
std::vector<Body> obstacle_bodies(const Scene& scene, const Plan& plan, std::int64_t step = 0);
/// Whether any of them moves as it is told.
bool has_moving_bodies(const Scene& scene);

/// The scene's obstacles that are meshes or images, in its order. @throws InputError  an image is
/// off the cells, or reaches out of the box
std::vector<Geometry> obstacle_shapes(const Scene& scene, const Plan& plan);

/// The scene's obstacles that are blocks, in its order. @throws InputError  one is off the cells
std::vector<CellBox> obstacle_blocks(const Scene& scene, const Plan& plan);

}  // namespace lbm
