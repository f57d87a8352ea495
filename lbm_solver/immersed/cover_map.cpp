// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/cover_map.h"

#include "lbm_solver/immersed/weight.h"

namespace lbm {
namespace {

constexpr double kWhole = 1.0 - 1e-12;  // a cell covered to round-off is covered whole

/// Calls f(block, lane, fraction, arm_x) for the cells of a span; `find` gives the block.
template <class Find, class F>
void for_each_cell(const Footprint::Span& span, const std::vector<double>& fractions, Find&& find,
                   F&& f) {
  for (int k = 0; k < span.count; ++k) {
    const int x = span.x + k;
    f(find(span.y, x / kPackWidth), x % kPackWidth, fractions[span.eps + k], span.arm_x + k);
  }
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
    b.eps.fill(0.0);
    b.us.fill(0.0);
    b.vs.fill(0.0);
    b.memory.fill(1.0);
  }
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
      Block& b = *block(y, x / kPackWidth);
      const int lane = x % kPackWidth;
      b.eps[lane] += 1.0;
      b.weight[lane] = b.surface[lane] = b.memory[lane] = 1.0;
      b.us[lane] = b.vs[lane] = 0.0;
    }
}

void CoverMap::place_row(int y, int x0, int x1) {
  for (int b = x0 / kPackWidth; b <= (x1 - 1) / kPackWidth; ++b) {
    const std::size_t i = static_cast<std::size_t>(y) * blocks_per_row_ + b;
    if (index_[i] >= 0) continue;
    index_[i] = static_cast<std::int32_t>(used_.size());
    used_.push_back(i);
  }
}

void CoverMap::place_blocks() {
  for (const std::size_t i : used_) index_[i] = -1;
  used_.clear();
  for (const Footprint& footprint : footprints_)
    for (const auto& span : footprint.spans()) place_row(span.y, span.x, span.x + span.count);
  for (const Wall& wall : walls_)
    for (int y = wall.y0; y < wall.y1; ++y) place_row(y, wall.x0, wall.x1);
  blocks_.assign(used_.size(), Block{});
}

void CoverMap::add(const Disc& disc, const Footprint& footprint) {
  const auto find = [this](int y, int b) { return block(y, b); };
  for (const auto& span : footprint.spans()) {
    const double row_u = disc.velocity.x() - disc.spin * span.arm_y;
    for_each_cell(span, footprint.fractions(), find,
                  [&](Block* b, int lane, double eps, double arm_x) {
                    b->eps[lane] += eps;
                    b->us[lane] += eps * row_u;
                    b->vs[lane] += eps * (disc.velocity.y() + disc.spin * arm_x);
                  });
    for (int x = span.x + span.core_begin; x < span.x + span.core_end; ++x)
      block(span.y, x / kPackWidth)->memory[x % kPackWidth] = 0.0;
  }
}

void CoverMap::finish() {
  for (Block& b : blocks_)
    for (int lane = 0; lane < kPackWidth; ++lane) {
      const double scale = b.eps[lane] > 0.0 ? 1.0 / b.eps[lane] : 0.0;
      b.us[lane] *= scale;
      b.vs[lane] *= scale;
      b.weight[lane] = immersed_weight(b.eps[lane], tau_);
      b.surface[lane] = b.eps[lane] < kWhole ? 1.0 : 0.0;
    }
}

std::vector<DiscLoad> CoverMap::loads() const {
  std::vector<DiscLoad> result(discs_.size());
  const auto find = [this](int y, int b) { return block(y, b); };
  for (std::size_t d = 0; d < discs_.size(); ++d) {
    DiscLoad& sum = result[d];
    for (const auto& span : footprints_[d].spans())
      for_each_cell(span, footprints_[d].fractions(), find,
                    [&](const Block* b, int lane, double eps, double arm_x) {
                      if (eps <= 0.0) return;
                      const double part = eps / b->eps[lane];
                      const Vec2 force(part * b->fx[lane], part * b->fy[lane]);
                      sum.force += force;
                      sum.torque += arm_x * force.y() - span.arm_y * force.x();
                    });
  }
  return result;
}

double CoverMap::solid_fraction(int x, int y) const {
  const Block* b = block(y, x / kPackWidth);
  return b ? b->eps[x % kPackWidth] : 0.0;
}

std::size_t CoverMap::bytes() const {
  return index_.size() * sizeof index_[0] + blocks_.size() * sizeof(Block);
}

}  // namespace lbm
