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

[[gnu::always_inline]] inline Pack solid_fraction(const Pack& dx, double dy, double dz,
                                                  double radius, bool sphere) {
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

Footprint::Change Footprint::look(const Body& body, const Domain& domain, const Block& cells) {
  const Vec3 centre = (body.centre / kSnap).array().round().matrix() * kSnap;
  if (centre == centre_ && body.radius == radius_ && body.hollow == hollow_) return Change::None;
  centre_ = centre;
  radius_ = body.radius;
  hollow_ = body.hollow;
  sphere_ = domain.dimension() == 3;
  row_end_ = cells.size[0];
  next_.clear();
  const Vec3 origin(cells.begin[0], cells.begin[1], cells.begin[2]);
  if (hollow_) {
    find_outside(centre - origin, cells);
  } else {
    const Images x = images(centre.x(), radius_, domain.nx, domain.x);
    const Images y = images(centre.y(), radius_, domain.ny, domain.y);
    const Images z = sphere_ ? images(centre.z(), radius_, domain.nz, domain.z) : Images{0.0, 1};
    for (int k = 0; k < z.count; ++k)
      for (int j = 0; j < y.count; ++j)
        for (int i = 0; i < x.count; ++i) {
          const Vec3 image(x.first + i * domain.nx, y.first + j * domain.ny,
                           z.first + k * domain.nz);
          find_image(image - origin, cells);
        }
  }
  const auto same = [](const Span& a, const Span& b) { return a.same_blocks(b); };
  return std::equal(next_.begin(), next_.end(), spans_.begin(), spans_.end(), same)
             ? Change::Fractions
             : Change::Spans;
}

void Footprint::write() {
  spans_.swap(next_);
  blocks_.resize(spans_.empty() ? 0 : spans_.back().first + spans_.back().blocks);
  for (const Span& span : spans_) write(span);
}

void Footprint::write(const Span& span) {
  for (int k = 0; k < span.blocks; ++k) {
    CoverBlock& block = blocks_[span.first + k];
    const int skipped = k * kPackWidth;
    const Pack lane = lane_numbers() + Pack(skipped);
    Pack cover = fractions(span, k);
    where(lane >= Pack(span.core_begin) && lane < Pack(span.core_end), cover) = Pack(kCore);
    store(block.cover.data(), cover);
    block.arm[0] = static_cast<float>(span.arm_x + skipped);
    block.arm[1] = static_cast<float>(span.arm_y);
    block.arm[2] = static_cast<float>(span.arm_z);
  }
}

/// All cells, with what the circle or sphere leaves of them; no images.
void Footprint::find_outside(const Vec3& centre, const Block& cells) {
  const int blocks = (row_end_ + kPackWidth - 1) / kPackWidth;
  const double core2 = square(radius_ + kCoreDepth);
  for (int z = 0; z < cells.size[2]; ++z)
    for (int y = 0; y < cells.size[1]; ++y) {
      const double dy = y + 0.5 - centre.y(), dz = sphere_ ? z + 0.5 - centre.z() : 0.0;
      for (int k = 0; k < blocks; ++k) {
        Span span{
            y,  z, k, 1, static_cast<int>(next_.size()), 0, 0, k * kPackWidth + 0.5 - centre.x(),
            dy, dz};
        if (all_of(fractions(span, 0) == Pack(0.0))) continue;
        const Pack dx = Pack(span.arm_x) + lane_numbers();
        if (all_of(dx * dx + Pack(dy * dy + dz * dz) > Pack(core2))) span.core_end = kPackWidth;
        next_.push_back(span);
      }
    }
}

void Footprint::find_image(const Vec3& centre, const Block& cells) {
  const double core = std::max(0.0, radius_ - kCoreDepth);
  int first = next_.empty() ? 0 : next_.back().first + next_.back().blocks;
  const auto [z_begin, z_end] =
      sphere_ ? cells_within(centre.z(), radius_, cells.size[2]) : std::pair{0, 1};
  for (int z = z_begin; z < z_end; ++z) {
    const double dz = sphere_ ? z + 0.5 - centre.z() : 0.0;
    const double near_z2 =
        square(std::max(0.0, std::abs(dz) - 0.5));  // closest approach of a layer
    const auto [y_begin, y_end] =
        cells_within(centre.y(), half_chord(radius_, near_z2), cells.size[1]);
    for (int y = y_begin; y < y_end; ++y) {
      const double dy = y + 0.5 - centre.y();
      const double near2 = square(std::max(0.0, std::abs(dy) - 0.5)) + near_z2;
      const auto [begin, end] = cells_within(centre.x(), half_chord(radius_, near2), row_end_);
      if (begin >= end) continue;
      const int block = begin / kPackWidth, x = block * kPackWidth;
      const double arm = x + 0.5 - centre.x();
      const double half_core = half_chord(core, dy * dy + dz * dz);
      const auto clip_core = [&, begin = begin, end = end](double at) {
        return std::clamp(static_cast<int>(std::ceil(at - arm)), begin - x, end - x);
      };
      const int blocks = (end - 1) / kPackWidth - block + 1;
      next_.push_back(
          {y, z, block, blocks, first, clip_core(-half_core), clip_core(half_core), arm, dy, dz});
      first += blocks;
    }
  }
}

/// Of the cells of block k of a span.
Pack Footprint::fractions(const Span& span, int k) const {
  const double arm = span.arm_x + k * kPackWidth;
  const double across2 = square(span.arm_y) + square(span.arm_z);
  const double inner2 = square(std::max(0.0, radius_ - half_diagonal(sphere_))) - across2;
  const int count = row_end_ - span.x() - k * kPackWidth;  // to the end of the row
  if (!hollow_ && count >= kPackWidth && square(arm) < inner2 &&
      square(arm + kPackWidth - 1) < inner2)
    return Pack(1.0);
  const Pack dx = Pack(arm) + lane_numbers();
  Pack fraction = solid_fraction(dx, span.arm_y, span.arm_z, radius_, sphere_);
  where(dx * dx < Pack(inner2), fraction) = Pack(1.0);
  if (hollow_) {
    fraction = Pack(1.0) - fraction;
    where(dx * dx > Pack(square(radius_ + half_diagonal(sphere_)) - across2), fraction) = Pack(1.0);
  }
  where(lane_numbers() >= Pack(count), fraction) = Pack(0.0);
  return fraction;
}

}  // namespace lbm
