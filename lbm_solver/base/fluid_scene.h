// SPDX-License-Identifier: GPL-2.0-or-later
/// The part of a scene that flows: the fluid, its viscosity, its start and its boundaries. SI
/// units.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "lbm_solver/base/side.h"
#include "lbm_solver/base/vec3.h"

namespace lbm {

/// Factor of a value over time, from a file.
struct TimeTableScene {
  std::vector<double> times, factors;  ///< [s], 1; empty: none
  bool repeats = false;

  /// Largest |factor|, 1 without a table.
  double largest() const {
    double most = times.empty() ? 1.0 : 0.0;
    for (const double f : factors) most = f > most ? f : -f > most ? -f : most;
    return most;
  }
};

/// Factor of a velocity along a side, from a file: on a grid of its axes, the first of which runs
/// first.
struct ProfileScene {
  std::array<std::vector<double>, 2> places;  ///< rising [m]; empty: the same all along this axis
  std::vector<double> factors;                ///< empty: there is no profile

  /// Largest |factor|, 1 without a profile.
  double largest() const {
    double most = factors.empty() ? 1.0 : 0.0;
    for (const double f : factors) most = f > most ? f : -f > most ? -f : most;
    return most;
  }
};

/// Something else than no-slip at rest on a part of a side.
struct BoundaryScene {
  enum class Kind { Velocity, Pressure, Outflow };
  SideName side = SideName::Left;
  Kind kind = Kind::Velocity;
  /// Along the side's axes in their order [m]; absent: its end.
  std::array<std::optional<double>, 2> from, to;
  Vec3 velocity;  ///< [m/s]; at the middle of a parabola
  bool parabolic = false;
  ProfileScene profile;             ///< velocity × factor along the side
  double pressure = 0.0;            ///< against the reference [Pa]
  std::optional<double> flow_rate;  ///< into the box, for which a pressure is found [m³/s]
  double ramp = 0.0;                ///< time in which the value comes up [s]
  double frequency = 0.0;           ///< value × cos(2 pi f t) [Hz]
  TimeTableScene table;             ///< value × factor
};

struct InitialScene {
  enum class Kind { Rest, Uniform, Channel, TaylorGreen, ShearLayer };
  Kind kind = Kind::Rest;
  Vec3 velocity;            ///< uniform [m/s]; x component: amplitude of the others
  double sharpness = 80.0;  ///< of the shear layers: kappa
  double perturbation = 0.05;
};

/// How the viscosity depends on the shear rate (viscosity/viscosity_law.h has the equations).
struct ViscosityScene {
  enum class Model { Newtonian, Smagorinsky, PowerLaw, Carreau, Bingham, HerschelBulkley };
  enum class Regularisation { BiViscosity, Papanastasiou };
  Model model = Model::Newtonian;
  double consistency = 0.0;              ///< K [Pa sⁿ]; of a Bingham fluid its plastic viscosity
  double index = 1.0;                    ///< n
  double yield_stress = 0.0;             ///< σ_y [Pa]
  double time_constant = 0.0;            ///< λ of Carreau's law [s]
  std::optional<double> nu_min, nu_max;  ///< bounds [m²/s]; absent: see ViscosityLaw
  std::optional<double> shear_rate;      ///< a typical one [1/s]; absent: typical_shear_rate
  Regularisation regularisation = Regularisation::BiViscosity;
  double smagorinsky = 0.0;  ///< S_c of the eddy viscosity that comes on top; 0: none
};

/// A flow through a periodic box, for which a body force is found.
struct FlowScene {
  double rate = 0.0;  ///< [m³/s]
  int axis = 0;
  double ramp = 0.0;  ///< time in which it comes up [s]
};

struct FluidScene {
  double density = 1000.0;  ///< [kg/m^3]
  double viscosity = 1e-6;  ///< kinematic [m^2/s]; where it varies, at the typical shear rate
  ViscosityScene law;
  Vec3 gravity;                     ///< [m/s^2]
  Vec3 body_force;                  ///< acceleration that drives the fluid [m/s^2]
  double body_force_ramp = 0;       ///< time in which it comes up [s]
  double body_force_frequency = 0;  ///< × cos(2 pi f t) [Hz]
  TimeTableScene body_force_table;  ///< × factor
  std::optional<FlowScene> flow;    ///< absent: nothing is held
  double velocity_scale = 0;        ///< largest expected speed of fluid or particles [m/s]
};

}  // namespace lbm
