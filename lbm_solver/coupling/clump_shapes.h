// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "lbm_solver/coupling/carrier.h"
#include "lbm_solver/immersed/body_scheme.h"

namespace lbm {

/// How the volume of each clump is spread: the union of the spheres that the lattice sees, measured
/// when they come, in a frame that they span. From then on it turns with them.
class ClumpShapes {
 public:
  /// @param flat  two dimensions; depth of discs [m]
  ClumpShapes(bool flat, double depth) : flat_(flat), depth_(depth) {}

  struct Placed {
    double volume = 0.0;  ///< of the union [m³]
    InnerShape shape;     ///< as it stands now
  };
  /// @param spheres  of one clump, in the order of their ids
  Placed place(const protocol::Shape& clump, std::span<const Sphere> spheres);
  /// Forgets all clumps but those that were placed since the last call.
  void keep_placed();

 private:
  struct Known {
    std::int64_t epoch = 0;
    std::vector<double> radii;
    double volume = 0.0;
    Vec3 centroid;
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // mean of x xᵀ, in the frame
    bool placed = false;
  };
  Known measure(std::span<const Sphere> spheres, const Eigen::Matrix3d& frame) const;

  bool flat_;
  double depth_;
  std::unordered_map<std::int64_t, Known> known_;  // [carrier]
};

/// Markers on the surface of a sphere would force the fluid inside the others, too.
/// @throws InputError
void expect_takes_clumps(SolidScheme scheme);

}  // namespace lbm
