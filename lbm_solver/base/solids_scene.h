// SPDX-License-Identifier: GPL-2.0-or-later
/// The part of a scene that is solid: obstacles, particles, and the coupling to their program. SI
/// units.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lbm_solver/base/motion.h"
#include "lbm_solver/base/triangle_mesh.h"
#include "lbm_solver/base/vec3.h"
#include "lbm_solver/base/voxels.h"
#include "protocol/wire/messages.h"

namespace lbm {

using protocol::Range;

/// A surface from a file, as it lies in the box.
struct MeshScene {
  std::string file;
  std::shared_ptr<const TriangleMesh> surface;  ///< closed [m]
  bool hollow = false;                          ///< solid is what lies outside of it
  double thickness = 0.0;                       ///< of a layer that was made of the surface [m]
  double volume = 0.0;                          ///< that it encloses [m^3]
  std::string other_scale;  ///< by which it would lie in the box, as a message says it
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
  std::string where;    ///< its table stands: file and line
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

}  // namespace lbm
