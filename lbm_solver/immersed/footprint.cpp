// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/footprint.h"

#include <algorithm>
#include <cmath>

#include "lbm_solver/immersed/solid_fraction.h"

namespace lbm {
namespace {

/// Fractions are all 0 farther outside the surface and all 1 deeper inside than half the diagonal
/// of a cell.
double half_diagonal(bool sphere) {
  return sphere ? 0.8661 : 0.7072;
}

/// First image of coordinate `at` that may touch [0, n], and how many images do.
struct Images {
  double first;
  int count;
};
Images images(double at, double radius, int n, Side side) {
  if (side == Side::Wall) return {at, 1};
  const double lowest = at - std::floor((at + radius) / n) * n;  // in [-radius, n - radius)
  return {lowest, lowest + n - radius < n ? 2 : 1};
}

/// Cells [first, second) of n that may lie within `half` of a centre.
std::pair<int, int> cells_within(double centre, double half, int n) {
  const auto clip = [n](double v) {
    return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(n)));
  };
  return {clip(std::floor(centre - half)), clip(std::ceil(centre + half))};
}

[[gnu::always_inline]] inline Pack fraction_of(const Pack& dx, double dy, double dz, double radius,
                                               bool sphere) {
  return sphere ? sphere_fraction(dx, Pack(dy), Pack(dz), radius)
                : disc_fraction(dx, Pack(dy), radius);
}

/// Half the length of a chord at a distance (squared) from the centre.
double half_chord(double radius, double distance2) {
  return std::sqrt(std::max(0.0, radius * radius - distance2));
}

double square(double v) {
  return v * v;
}

}  // namespace

bool Footprint::update(const Body& body, const Domain& domain, const Block& cells) {
  const Vec3 centre = (body.centre / kSnap).array().round().matrix() * kSnap;
  if (centre == centre_ && body.radius == radius_ && body.hollow == hollow_) return false;
  centre_ = centre;
  radius_ = body.radius;
  hollow_ = body.hollow;
  spans_.clear();
  fractions_.clear();
  const bool sphere = domain.dimension() == 3;
  const Vec3 origin(cells.begin[0], cells.begin[1], cells.begin[2]);
  if (body.hollow) {
    add_outside(centre - origin, body.radius, cells, sphere);
    return true;
  }
  const Images x = images(centre.x(), body.radius, domain.nx, domain.x);
  const Images y = images(centre.y(), body.radius, domain.ny, domain.y);
  const Images z = sphere ? images(centre.z(), body.radius, domain.nz, domain.z) : Images{0.0, 1};
  for (int k = 0; k < z.count; ++k)
    for (int j = 0; j < y.count; ++j)
      for (int i = 0; i < x.count; ++i) {
        const Vec3 image(x.first + i * domain.nx, y.first + j * domain.ny, z.first + k * domain.nz);
        add_image(image - origin, body.radius, cells, sphere);
      }
  return true;
}

/// All cells, with what the circle or sphere leaves of them; no images.
void Footprint::add_outside(const Vec3& centre, double radius, const Block& cells, bool sphere) {
  const int nx = cells.size[0], blocks = (nx + kPackWidth - 1) / kPackWidth;
  const double core2 = square(radius + kCoreDepth);
  const Pack full2(square(radius + half_diagonal(sphere)));
  for (int z = 0; z < cells.size[2]; ++z)
    for (int y = 0; y < cells.size[1]; ++y) {
      const double dy = y + 0.5 - centre.y(), dz = sphere ? z + 0.5 - centre.z() : 0.0;
      for (int k = 0; k < blocks; ++k) {
        const double first_arm = k * kPackWidth + 0.5 - centre.x();
        const Pack dx = Pack(first_arm) + lane_numbers();
        const Pack distance2 = dx * dx + Pack(dy * dy + dz * dz);
        Pack fraction = Pack(1.0) - fraction_of(dx, dy, dz, radius, sphere);
        where(distance2 > full2, fraction) = Pack(1.0);
        where(Pack(k * kPackWidth) + lane_numbers() >= Pack(nx), fraction) = Pack(0.0);
        if (all_of(fraction == Pack(0.0))) continue;
        const int eps = static_cast<int>(fractions_.size());
        fractions_.resize(fractions_.size() + kPackWidth);
        store(&fractions_[eps], fraction);
        const bool deep = all_of(distance2 > Pack(core2));
        spans_.push_back({y, z, k, 1, eps, 0, deep ? kPackWidth : 0, first_arm, dy, dz});
      }
    }
}

void Footprint::add_image(const Vec3& centre, double radius, const Block& cells, bool sphere) {
  const double core = std::max(0.0, radius - kCoreDepth);
  const auto [z_begin, z_end] =
      sphere ? cells_within(centre.z(), radius, cells.size[2]) : std::pair{0, 1};
  for (int z = z_begin; z < z_end; ++z) {
    const double dz = sphere ? z + 0.5 - centre.z() : 0.0;
    const double near_z2 =
        square(std::max(0.0, std::abs(dz) - 0.5));  // closest approach of a layer
    const auto [y_begin, y_end] =
        cells_within(centre.y(), half_chord(radius, near_z2), cells.size[1]);
    for (int y = y_begin; y < y_end; ++y) {
      const double dy = y + 0.5 - centre.y();
      const double near2 = square(std::max(0.0, std::abs(dy) - 0.5)) + near_z2;
      const auto [begin, end] = cells_within(centre.x(), half_chord(radius, near2), cells.size[0]);
      if (begin >= end) continue;
      const int block = begin / kPackWidth, first = block * kPackWidth;
      const double arm = first + 0.5 - centre.x();
      const double half_core = half_chord(core, dy * dy + dz * dz);
      const auto clip_core = [&, begin = begin, end = end](double at) {
        return std::clamp(static_cast<int>(std::ceil(at - arm)), begin - first, end - first);
      };
      const int blocks = (end - 1) / kPackWidth - block + 1;
      add_row({y, z, block, blocks, static_cast<int>(fractions_.size()), clip_core(-half_core),
               clip_core(half_core), arm, dy, dz},
              cells.size[0] - first, dy * dy + dz * dz, radius, sphere);
    }
  }
}

/// Fractions of one row. @param count  cells from the first lane to the end of the lattice
void Footprint::add_row(const Span& row, int count, double across2, double radius, bool sphere) {
  spans_.push_back(row);
  fractions_.resize(fractions_.size() + static_cast<std::size_t>(row.count()));
  const double inner2 = square(std::max(0.0, radius - half_diagonal(sphere))) - across2;
  for (int k = 0; k < row.blocks; ++k) {
    const double arm = row.arm_x + k * kPackWidth;
    double* const fractions = &fractions_[row.eps + k * kPackWidth];
    if (square(arm) < inner2 && square(arm + kPackWidth - 1) < inner2) {
      store(fractions, Pack(1.0));
      continue;
    }
    const Pack dx = Pack(arm) + lane_numbers();
    Pack fraction = fraction_of(dx, row.arm_y, row.arm_z, radius, sphere);
    where(dx * dx < Pack(inner2), fraction) = Pack(1.0);
    store(fractions, fraction);
  }
  std::fill(fractions_.begin() + row.eps + std::min(row.count(), count), fractions_.end(),
            0.0);  // no cells beyond the end of the row
}

}  // namespace lbm
