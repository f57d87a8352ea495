// SPDX-License-Identifier: GPL-2.0-or-later
/// A scene as its author wrote it: plain data in SI units. `io/scene_reader` fills it,
/// `solver/plan` turns it into numbers for the lattice.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lbm_solver/base/motion.h"
#include "lbm_solver/base/side.h"
#include "lbm_solver/base/triangle_mesh.h"
#include "lbm_solver/base/units.h"
#include "lbm_solver/base/voxels.h"
#include "protocol/wire/messages.h"

namespace lbm {

using protocol::Range;

enum class SideKind { Wall, Periodic };

struct BoxScene {
  int dimension = 2;
  Vec3 size;           ///< [m]; z in three dimensions only
  Vec3 origin;         ///< lower corner [m]
  double depth = 1.0;  ///< of the layer in two dimensions [m]
  std::array<SideKind, 3> sides{SideKind::Wall, SideKind::Wall, SideKind::Wall};
  Vec3 pressure_jump;  ///< across periodic sides, low minus high [Pa]
};

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

/// A surface from a file, as it lies in the box.
struct MeshScene {
  std::string file;
  std::shared_ptr<const TriangleMesh> surface;  ///< closed [m]
  bool hollow = false;                          ///< solid is what lies outside of it
  double thickness = 0.0;                       ///< of a layer that was made of the surface [m]
  double volume = 0.0;                          ///< that it encloses [m^3]
};

/// An image from a file, as solid fractions.
struct ImageScene {
  std::string file;
  std::shared_ptr<const Voxels> voxels;
  double voxel = 0.0;  ///< size of one [m]
  Vec3 at;             ///< lower corner [m]
};

/// A solid that stays where it is, or moves as it is told: a disc or sphere (curved, it may spin),
/// a block of whole cells, a mesh or an image. A block that moves is the mesh of a box.
struct ObstacleScene {
  bool round = false;   ///< a disc, in three dimensions a sphere
  bool hollow = false;  ///< round, and solid outside
  bool grain = false;   ///< one of a file of many: its load is not listed by itself
  Vec3 spin;            ///< of a round one [rad/s]
  Vec3 centre;
  double diameter = 0.0;  ///< [m]
  Vec3 from, to;          ///< corners of a block [m]
  std::optional<MeshScene> mesh;
  std::optional<ImageScene> image;
  std::optional<MotionScene> motion;

  bool block() const { return !round && !mesh && !image; }
  /// A drum: hollow and moving. It is mapped as a shell of some cells, with fluid around it.
  bool drum() const { return round && hollow && motion; }
  /// Placed as a body, as grains are.
  bool body() const { return round && !drum(); }
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

struct NumericsScene {
  std::optional<double> cell;                ///< [m]
  std::optional<double> cells_per_diameter;  ///< instead of `cell`: of the smallest particle
  std::optional<double> time_step;           ///< fluid step [s]; absent: chosen by rule
  std::string lattice = "auto";              ///< D2Q9, D3Q19 or D3Q27; auto: D2Q9, D3Q19
  bool single = false;                       ///< populations in single precision
  std::string collision = "auto";            ///< see solver/plan.h for what auto takes
  std::string solid_term = "auto";
  std::string scheme = "auto";      ///< auto, or the name of a SolidScheme
  double spring_stiffness = 0.001;  ///< of the spring scheme, lattice units
  std::string weight = "auto";      ///< viscous, balanced or fraction; auto: viscous, balanced
  std::optional<double> magic;      ///< Λ of TRT; absent: see solver/plan.h
  double smagorinsky = 0.0;         ///< S_c; 0: no turbulence model
  bool wale = false;                ///< its eddy viscosity adapts to walls
  bool equal_work = false;          ///< blocks of the ranks: of equal work instead of equal size
  double waiting_bound = 0.1;       ///< share of waiting above which those are cut anew
};

struct ParticleScene {
  Range diameter;                            ///< [m]
  Range density;                             ///< [kg/m^3]
  std::vector<double> hydraulic_ratio{1.0};  ///< radius that the flow sees / radius, a type each
  std::vector<Vec3> start;  ///< centres [m], offered to the script as particle_x …
  std::optional<double> contact_stiffness;       ///< [N/m]; bounds the solid's step
  std::map<std::string, std::string> variables;  ///< further names for the script
};

struct CouplingScene {
  int fluid_steps = 1;          ///< a coupling interval
  std::optional<int> substeps;  ///< solid steps a coupling interval; absent: from the stiffness
  bool inner_inertia = true;    ///< correct for the inertia of the fluid inside a particle
  protocol::Buoyancy buoyancy = protocol::Buoyancy::ByFluid;
  std::optional<double> virtual_mass;  ///< over covered fluid; absent: where particles are light
  /// A body force on the fluid carries the weight of all particles in it, whatever their number.
  bool carry_weight = false;
  double lubrication_range = 0.0;  ///< gap below which it acts [cells]; 0: off
  bool overlapped = false;         ///< both programs at once, loads one interval old
  double timeout = 300.0;          ///< longest wait for the solid [s]
  double connect_timeout = 30.0;   ///< how long its program may take to start [s]
};

/// Something that is measured along the run and written to a table of its own.
struct SensorScene {
  enum class Kind { Line, Plane, Side };
  Kind kind = Kind::Plane;
  std::string name;  ///< of its table, sensor-NAME.csv
  double every = 0;  ///< [s]; 0: every interval
  Vec3 from, to;   ///< ends of a line; corners of the part of the box whose cells a plane takes [m]
  int count = 20;  ///< places of a line
  int axis = 0;    ///< normal of a plane
  double at = 0.0;  ///< place of a plane along it [m]
  SideName side = SideName::Left;
};

/// Mean values of the fields over time.
struct AverageScene {
  double from = 0.0;   ///< [s]
  double every = 0.0;  ///< between two samples [s]; 0: every interval
};

struct OutputScene {
  double fields_every = 0.0;  ///< [s]; 0: none
  bool viscosity = false;     ///< among the fields
  double probe_every = 0.0;   ///< [s]; 0: every interval
  std::vector<Vec3> points;   ///< places where pressure and velocity are written [m]
  /// Numbers (ids) of the particles that have rows in the table of probes; empty: all.
  std::vector<std::int64_t> probe_particles;
  std::optional<AverageScene> average;
  std::vector<SensorScene> sensors;
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
