// SPDX-License-Identifier: MIT
/// bplbm_clump, on the rest of the C interface: a clump's carrier from its spheres.
#include <algorithm>
#include <cmath>
#include <new>
#include <vector>

#include "protocol/solid/bplbm_solid.h"
#include "protocol/wire/ball_union.h"
#include "protocol/wire/text.h"

using namespace protocol;

namespace {

/// What can be no clump: the number of its first sphere that is wrong, from 1; 0 where all are
/// good.
std::int64_t first_wrong(const std::vector<Ball>& balls, const bplbm_setup& setup) {
  double most = 0.0;  // what is larger has no place in the box, and would take long to integrate
  for (int k = 0; k < setup.dimension; ++k)
    most = std::max(most, setup.box_high[k] - setup.box_low[k]);
  const auto wrong = [most](const Ball& b) {
    const auto small = [most](double x) {
      return std::abs(x) <= most;
    };  // what is no number is not
    return !(b.radius > 0.0 && small(b.radius) && std::ranges::all_of(b.x, small));
  };
  const auto found = std::ranges::find_if(balls, wrong);
  return found == balls.end() ? 0 : found - balls.begin() + 1;
}

/// About the centre of their union. @return where that is
Vec3 move_to_centre(std::vector<Ball>& balls, const bplbm_setup& setup) {
  const Vec3 centre =
      moments_of_union(balls, static_cast<unsigned>(setup.dimension), setup.depth).centroid;
  for (Ball& b : balls)
    for (int k = 0; k < setup.dimension; ++k) b.x[k] -= centre[k];
  return centre;
}

}  // namespace

int bplbm_clump(bplbm_solid* solid, int64_t n, const double* places, const double* radii,
                double density, bplbm_shape* carrier, double centre[3], double inertia[6]) try {
  bplbm_setup setup{};
  if (const int code = bplbm_scene(solid, &setup); code != BPLBM_OK) return code;
  if (n < 1 || !places || !radii || !carrier || !(density > 0.0) || !std::isfinite(density))
    return bplbm_fail(
        solid, BPLBM_BAD_INPUT,
        "bplbm_clump: give places and radii of at least one sphere, a density above 0, "
        "and a shape");
  std::vector<Ball> balls;
  for (int64_t i = 0; i < n; ++i) {
    const double* x = places + 3 * i;
    const double z = setup.dimension == 2 ? 0.0 : x[2];
    balls.push_back({.x = {x[0], x[1], z}, .radius = radii[i]});
  }
  if (const auto i = first_wrong(balls, setup))
    return bplbm_fail(
        solid, BPLBM_BAD_INPUT,
        format("bplbm_clump: sphere {} is at ({}, {}, {}) m with a radius of {} m; give "
               "finite numbers, radii above 0, and a clump no larger than the box",
               i, places[3 * i - 3], places[3 * i - 2], places[3 * i - 1], radii[i - 1])
            .c_str());
  const Vec3 at = move_to_centre(balls, setup);
  const UnionMoments all =
      moments_of_union(balls, static_cast<unsigned>(setup.dimension), setup.depth);
  const double m = density * all.volume;
  const auto& [xx, yy, zz, yz, zx, xy] = all.second;
  const double about = setup.dimension == 2 ? xx + yy : (xx + yy + zz) * 2.0 / 3.0;
  *carrier = {0, bounding_radius(balls), m, m * about, 1, 0, BPLBM_ITSELF, all.volume};
  const double tensor[6] = {m * (yy + zz), m * (zz + xx), m * (xx + yy), -m * yz, -m * zx, -m * xy};
  if (centre) std::copy(at.begin(), at.end(), centre);
  if (inertia) std::copy_n(tensor, 6, inertia);
  return BPLBM_OK;
} catch (const std::bad_alloc&) {
  return bplbm_fail(solid, BPLBM_FAULT, "bplbm_clump: there is no memory for the spheres");
}
