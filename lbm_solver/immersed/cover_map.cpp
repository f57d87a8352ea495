// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/cover_map.h"

#include <algorithm>

#include "lbm_solver/immersed/weight.h"

namespace lbm {
namespace {

constexpr double kWhole = 1.0 - 1e-12;  // a cell covered to round-off is covered whole

/// 0, 1, 2, … in the lanes of a pack.
Pack lane_numbers() {
  return Pack([](auto lane) { return static_cast<double>(lane); });
}

Pack pack(const std::array<double, kPackWidth>& lanes) {
  return load<Pack>(lanes.data());
}

}  // namespace

CoverMap::CoverMap(const Domain& domain, double tau)
    : domain_(domain),
      tau_(tau),
      blocks_per_row_((domain.nx + kPackWidth - 1) / kPackWidth),
      index_(static_cast<std::size_t>(blocks_per_row_) * domain.ny, -1) {}

void CoverMap::update(std::span<const Disc> discs) {
  bool moved = walls_changed_ || discs.size() != discs_.size();
  walls_changed_ = false;
  discs_.assign(discs.begin(), discs.end());
  footprints_.resize(discs.size());
  for (std::size_t d = 0; d < discs.size(); ++d)
    moved = footprints_[d].update(discs[d], domain_) || moved;
  if (moved) place_blocks();
  for (Block& b : blocks_) {
    b.us.fill(0.0);
    b.vs.fill(0.0);
    b.layer.fill(0.0);
  }
  for (Share& s : shares_) s.eps.fill(0.0);
  for (std::size_t d = 0; d < discs.size(); ++d) add(discs_[d], footprints_[d]);
  finish();
  for (const Wall& wall : walls_) add(wall);
}

void CoverMap::add_wall(int x0, int y0, int x1, int y1) {
  walls_.push_back({x0, y0, x1, y1});
  walls_changed_ = true;
}

/// A wall cell takes no part in what the discs do: full bounce-back, whatever else is in the cell.
void CoverMap::add(const Wall& wall) {
  for (int y = wall.y0; y < wall.y1; ++y)
    for (int x = wall.x0; x < wall.x1; ++x) {
      const std::int32_t index = record(y, x / kPackWidth);
      Block& b = blocks_[index];
      Share& s = shares_[index];
      const int lane = x % kPackWidth;
      s.eps[lane] += 1.0;
      s.per_eps[lane] = 1.0 / s.eps[lane];
      b.weight[lane] = b.layer[lane] = 1.0;
      b.us[lane] = b.vs[lane] = 0.0;
    }
}

void CoverMap::mark(int y, int x0, int x1) {
  std::int32_t* row = &index_[static_cast<std::size_t>(y) * blocks_per_row_];
  for (int b = x0 / kPackWidth; b <= (x1 - 1) / kPackWidth; ++b) row[b] = 0;
}

/// Records are numbered in the order in which a sweep meets them: it then reads them one after
/// another.
void CoverMap::place_blocks() {
  std::fill(index_.begin(), index_.end(), -1);
  for (const Footprint& footprint : footprints_)
    for (const auto& span : footprint.spans()) mark(span.y, span.x(), span.x() + span.count());
  for (const Wall& wall : walls_)
    for (int y = wall.y0; y < wall.y1; ++y) mark(y, wall.x0, wall.x1);
  std::int32_t records = 0;
  for (std::int32_t& index : index_)
    if (index >= 0) index = records++;
  blocks_.resize(records);
  shares_.resize(records);
}

void CoverMap::add(const Disc& disc, const Footprint& footprint) {
  const Pack lanes = lane_numbers();
  for (const auto& span : footprint.spans()) {
    const Pack u(disc.velocity.x() - disc.spin * span.arm_y);
    for (int k = 0; k < span.blocks; ++k) {
      const std::int32_t index = record(span.y, span.block + k);
      Block& b = blocks_[index];
      Lanes& sum = shares_[index].eps;
      const Pack eps = load<Pack>(&footprint.fractions()[span.eps + k * kPackWidth]);
      const Pack arm_x = Pack(span.arm_x + k * kPackWidth) + lanes;
      store(sum.data(), pack(sum) + eps);
      store(b.us.data(), pack(b.us) + eps * u);
      store(b.vs.data(), pack(b.vs) + eps * (Pack(disc.velocity.y()) + Pack(disc.spin) * arm_x));
    }
    const int first = span.x();
    for (int x = first + span.core_begin; x < first + span.core_end; ++x)
      block(span.y, x / kPackWidth)->layer[x % kPackWidth] = -1.0;
  }
}

void CoverMap::finish() {
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    for (int lane = 0; lane < kPackWidth; ++lane) {
      Block& b = blocks_[i];
      const double eps = shares_[i].eps[lane], scale = eps > 0.0 ? 1.0 / eps : 0.0;
      shares_[i].per_eps[lane] = scale;
      b.us[lane] *= scale;
      b.vs[lane] *= scale;
      b.weight[lane] = immersed_weight(eps, tau_);
      if (eps < kWhole) b.layer[lane] = 1.0;
    }
}

std::vector<DiscLoad> CoverMap::loads() const {
  std::vector<DiscLoad> result(discs_.size());
  const Pack lanes = lane_numbers();
  for (std::size_t d = 0; d < discs_.size(); ++d) {
    Pack fx(0.0), fy(0.0), torque(0.0);
    for (const auto& span : footprints_[d].spans())
      for (int k = 0; k < span.blocks; ++k) {
        const std::int32_t index = record(span.y, span.block + k);
        const Block& b = blocks_[index];
        const Pack eps = load<Pack>(&footprints_[d].fractions()[span.eps + k * kPackWidth]);
        const Pack part = eps * pack(shares_[index].per_eps);
        const Pack x = part * pack(b.fx), y = part * pack(b.fy);
        fx += x;
        fy += y;
        torque += (Pack(span.arm_x + k * kPackWidth) + lanes) * y - Pack(span.arm_y) * x;
      }
    using std::experimental::reduce;
    result[d] = {{reduce(fx), reduce(fy)}, reduce(torque)};
  }
  return result;
}

double CoverMap::solid_fraction(int x, int y) const {
  const std::int32_t index = record(y, x / kPackWidth);
  return index < 0 ? 0.0 : shares_[index].eps[x % kPackWidth];
}

std::size_t CoverMap::bytes() const {
  return index_.size() * sizeof index_[0] + blocks_.size() * (sizeof(Block) + sizeof(Share));
}

}  // namespace lbm
