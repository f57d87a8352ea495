// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/cover_map.h"

#include <algorithm>

namespace lbm {
namespace {

constexpr double kWhole = 1.0 - 1e-12;  // a cell covered to round-off is covered whole
constexpr std::size_t kManyDiscs = 64;  // from which on it pays to divide them among threads

Pack pack(const std::array<double, kPackWidth>& lanes) {
  return load<Pack>(lanes.data());
}

/// 1 surface, 0 whole, -1 core, from a solid fraction and the lanes [begin, end) of a core.
Pack layer_of(const Pack& eps, int core_begin, int core_end) {
  const Pack lane = lane_numbers();
  Pack layer(0.0);
  where(eps < Pack(kWhole), layer) = Pack(1.0);
  where(lane >= Pack(core_begin) && lane < Pack(core_end), layer) = Pack(-1.0);
  return layer;
}

/// Velocity of a disc's material at the cells of a block.
struct Velocity {
  Pack x, y;
  Velocity(const Disc& disc, const Footprint::Span& span, int k)
      : x(disc.velocity.x() - disc.spin * span.arm_y),
        y(Pack(disc.velocity.y()) +
          Pack(disc.spin) * (Pack(span.arm_x + k * kPackWidth) + lane_numbers())) {}
};

bool same_motion(const Disc& a, const Disc& b) {
  return a.velocity == b.velocity && a.spin == b.spin;
}

}  // namespace

CoverMap::CoverMap(const Domain& domain, const ImmersedWeight& weight)
    : domain_(domain),
      weight_(weight),
      blocks_per_row_((domain.nx + kPackWidth - 1) / kPackWidth),
      index_(static_cast<std::size_t>(blocks_per_row_) * domain.ny) {}

void CoverMap::update(std::span<const Disc> discs) {
  bool moved = walls_changed_ || discs.size() != discs_.size(), changed = moved;
  walls_changed_ = false;
  footprints_.resize(discs.size());
  for (std::size_t d = 0; d < discs.size() && !changed; ++d)
    changed = !same_motion(discs[d], discs_[d]);
  discs_.assign(discs.begin(), discs.end());
  const auto n = static_cast<std::ptrdiff_t>(discs.size());
#pragma omp parallel for schedule(static) reduction(|| : moved) if (discs.size() >= kManyDiscs)
  for (std::ptrdiff_t d = 0; d < n; ++d) moved = footprints_[d].update(discs_[d], domain_) || moved;
  if (!moved && !changed) return;
  if (moved) place_blocks();
#pragma omp parallel for schedule(static) if (discs.size() >= kManyDiscs)
  for (std::ptrdiff_t d = 0; d < n; ++d) write(discs_[d], footprints_[d]);
  if (!shares_.empty()) {
    begin_shared();
    for (std::ptrdiff_t d = 0; d < n; ++d) share(discs_[d], footprints_[d]);
    finish_shared();
  }
  for (const Wall& wall : walls_) write(wall);
}

void CoverMap::add_wall(int x0, int y0, int x1, int y1) {
  walls_.push_back({x0, y0, x1, y1});
  walls_changed_ = true;
}

/// Counts a solid in blocks of row y; `share` holds the number until places are given.
void CoverMap::count(int y, int first_block, int blocks) {
  Entry* entries = &index_[static_cast<std::size_t>(y) * blocks_per_row_ + first_block];
  for (int k = 0; k < blocks; ++k) ++entries[k].share;
}

/// Records are numbered in the order in which a sweep meets them: it then reads them one after
/// another.
void CoverMap::place_blocks() {
  std::fill(index_.begin(), index_.end(), Entry{});
  for (const Footprint& footprint : footprints_)
    for (const auto& span : footprint.spans()) count(span.y, span.block, span.blocks);
  for (const Wall& wall : walls_)
    for (int y = wall.y0; y < wall.y1; ++y) {
      const int first = wall.x0 / kPackWidth;
      count(y, first, (wall.x1 - 1) / kPackWidth - first + 1);
    }
  std::int32_t records = 0;
  shares_.clear();
  for (Entry& e : index_) {
    if (e.share < 0) continue;
    e.record = records++;
    const bool alone = e.share == 0;
    e.share = alone ? -1 : static_cast<std::int32_t>(shares_.size());
    if (!alone) shares_.push_back({{}, e.record});
  }
  blocks_.resize(records);
  for (const Wall& wall : walls_)  // a block may hold fluid beside the wall
    for (int y = wall.y0; y < wall.y1; ++y)
      for (int b = wall.x0 / kPackWidth; b <= (wall.x1 - 1) / kPackWidth; ++b)
        if (entry(y, b).share < 0) *block(y, b) = Block{};
}

/// Records of blocks that the disc has for itself, complete.
void CoverMap::write(const Disc& disc, const Footprint& footprint) {
  for (const auto& span : footprint.spans())
    for (int k = 0; k < span.blocks; ++k) {
      const Entry& e = entry(span.y, span.block + k);
      if (e.share >= 0) continue;
      Block& b = blocks_[e.record];
      const Pack eps = load<Pack>(&footprint.fractions()[span.eps + k * kPackWidth]);
      const Velocity u(disc, span, k);
      const int skipped = k * kPackWidth;
      store(b.weight.data(), weight_(eps));
      store(b.layer.data(), layer_of(eps, span.core_begin - skipped, span.core_end - skipped));
      store(b.us.data(), u.x);
      store(b.vs.data(), u.y);
    }
}

void CoverMap::begin_shared() {
  for (Share& s : shares_) {
    Block& b = blocks_[s.record];
    s.eps.fill(0.0);
    b.us.fill(0.0);
    b.vs.fill(0.0);
    b.layer.fill(1.0);
  }
}

/// Adds a disc to the records of blocks that it shares: sums weighted with ε.
void CoverMap::share(const Disc& disc, const Footprint& footprint) {
  for (const auto& span : footprint.spans())
    for (int k = 0; k < span.blocks; ++k) {
      const Entry& e = entry(span.y, span.block + k);
      if (e.share < 0) continue;
      Block& b = blocks_[e.record];
      Lanes& sum = shares_[e.share].eps;
      const Pack eps = load<Pack>(&footprint.fractions()[span.eps + k * kPackWidth]);
      const Velocity u(disc, span, k);
      const int skipped = k * kPackWidth;
      const Pack layer = layer_of(eps, span.core_begin - skipped, span.core_end - skipped);
      using std::min;
      store(b.layer.data(), min(pack(b.layer), layer));
      store(sum.data(), pack(sum) + eps);
      store(b.us.data(), pack(b.us) + eps * u.x);
      store(b.vs.data(), pack(b.vs) + eps * u.y);
    }
}

void CoverMap::finish_shared() {
  for (const Share& s : shares_) {
    Block& b = blocks_[s.record];
    const Pack eps = pack(s.eps);
    Pack scale(0.0), layer = pack(b.layer);
    where(eps > Pack(0.0), scale) = Pack(1.0) / eps;
    using std::min;
    where(eps >= Pack(kWhole), layer) = min(layer, Pack(0.0));
    store(b.us.data(), scale * pack(b.us));
    store(b.vs.data(), scale * pack(b.vs));
    store(b.weight.data(), weight_(eps));
    store(b.layer.data(), layer);
  }
}

/// A wall cell takes no part in what the discs do: full bounce-back, whatever else is in the cell.
void CoverMap::write(const Wall& wall) {
  for (int y = wall.y0; y < wall.y1; ++y)
    for (int x = wall.x0; x < wall.x1; ++x) {
      const Entry& e = entry(y, x / kPackWidth);
      Block& b = blocks_[e.record];
      const int lane = x % kPackWidth;
      if (e.share >= 0) shares_[e.share].eps[lane] += 1.0;
      b.weight[lane] = b.layer[lane] = 1.0;
      b.us[lane] = b.vs[lane] = 0.0;
    }
}

std::vector<DiscLoad> CoverMap::loads() const {
  std::vector<DiscLoad> result(discs_.size());
  const auto n = static_cast<std::ptrdiff_t>(discs_.size());
#pragma omp parallel for schedule(static) if (discs_.size() >= kManyDiscs)
  for (std::ptrdiff_t d = 0; d < n; ++d) {
    Pack fx(0.0), fy(0.0), torque(0.0);
    for (const auto& span : footprints_[d].spans())
      for (int k = 0; k < span.blocks; ++k) {
        const Entry& e = entry(span.y, span.block + k);
        const Block& b = blocks_[e.record];
        Pack x = pack(b.fx), y = pack(b.fy);
        if (e.share >= 0) {
          const Pack eps = load<Pack>(&footprints_[d].fractions()[span.eps + k * kPackWidth]);
          Pack part(0.0);
          where(eps > Pack(0.0), part) = eps / pack(shares_[e.share].eps);
          x *= part;
          y *= part;
        }
        fx += x;
        fy += y;
        torque += (Pack(span.arm_x + k * kPackWidth) + lane_numbers()) * y - Pack(span.arm_y) * x;
      }
    using std::experimental::reduce;
    result[d] = {{reduce(fx), reduce(fy)}, reduce(torque)};
  }
  return result;
}

double CoverMap::solid_fraction(int x, int y) const {
  const Entry& e = entry(y, x / kPackWidth);
  const int lane = x % kPackWidth;
  if (e.record < 0) return 0.0;
  if (e.share >= 0) return std::min(1.0, shares_[e.share].eps[lane]);
  return weight_.fraction(blocks_[e.record].weight[lane]);
}

std::size_t CoverMap::bytes() const {
  return index_.size() * sizeof index_[0] + blocks_.size() * sizeof(Block) +
         shares_.size() * sizeof(Share);
}

}  // namespace lbm
