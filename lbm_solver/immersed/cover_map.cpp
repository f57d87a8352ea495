// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/cover_map.h"

#include <algorithm>

namespace lbm {
namespace {

constexpr double kWhole = 1.0 - 1e-12;   // a cell covered to round-off is covered whole
constexpr std::size_t kManyBodies = 64;  // from which on it pays to divide them among threads

Pack pack(const Lanes& lanes) {
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

/// Velocity v + ω × r of a body's material at the cells of a block; discs turn about z alone.
template <int D>
struct Velocity {
  Pack at[D];
  Velocity(const Body& body, const Footprint::Span& s, int k) {
    const Vec3 &v = body.velocity, &w = body.spin;
    const Pack x = Pack(s.arm_x + k * kPackWidth) + lane_numbers();
    at[0] = Pack(v.x() - w.z() * s.arm_y + (D == 3 ? w.y() * s.arm_z : 0.0));
    at[1] = Pack(v.y() - (D == 3 ? w.x() * s.arm_z : 0.0)) + Pack(w.z()) * x;
    if constexpr (D == 3) at[2] = Pack(v.z() + w.x() * s.arm_y) - Pack(w.y()) * x;
  }
};

bool same_motion(const Body& a, const Body& b) {
  return a.velocity == b.velocity && a.spin == b.spin;
}

}  // namespace

CoverMap::CoverMap(const Domain& domain, const Block& cells, const ImmersedWeight& weight)
    : domain_(domain),
      cells_(cells),
      d_(domain.dimension()),
      size_(2 + 2 * d_),
      weight_(weight),
      blocks_per_row_((cells.size[0] + kPackWidth - 1) / kPackWidth),
      index_(static_cast<std::size_t>(blocks_per_row_) * cells.size[1] * cells.size[2]) {}

void CoverMap::update(std::span<const Body> bodies) {
  bool moved = walls_changed_ || bodies.size() != bodies_.size(), changed = moved;
  walls_changed_ = false;
  footprints_.resize(bodies.size());
  for (std::size_t d = 0; d < bodies.size() && !changed; ++d)
    changed = !same_motion(bodies[d], bodies_[d]);
  bodies_.assign(bodies.begin(), bodies.end());
  const auto n = static_cast<std::ptrdiff_t>(bodies.size());
#pragma omp parallel for schedule(static) reduction(|| : moved) if (bodies.size() >= kManyBodies)
  for (std::ptrdiff_t d = 0; d < n; ++d)
    moved = footprints_[d].update(bodies_[d], domain_, cells_) || moved;
  if (!moved && !changed) return;
  if (moved) place_blocks();
  const auto write_all = [&](auto dimension) {
    constexpr int D = dimension;
#pragma omp parallel for schedule(static) if (bodies.size() >= kManyBodies)
    for (std::ptrdiff_t d = 0; d < n; ++d) write<D>(bodies_[d], footprints_[d]);
    if (shares_.empty()) return;
    begin_shared();
    for (std::ptrdiff_t d = 0; d < n; ++d) share<D>(bodies_[d], footprints_[d]);
    finish_shared();
  };
  if (d_ == 2)
    write_all(std::integral_constant<int, 2>{});
  else
    write_all(std::integral_constant<int, 3>{});
  for (const Wall& wall : walls_) write(wall);
}

void CoverMap::add_wall(const Cell3& from, const Cell3& to) {
  Wall wall{from, to};
  for (int a = 0; a < 3; ++a) {
    wall.from[a] = std::max(0, from[a] - cells_.begin[a]);
    wall.to[a] = std::min(cells_.size[a], to[a] - cells_.begin[a]);
    if (wall.from[a] >= wall.to[a]) return;  // on other ranks alone
  }
  walls_.push_back(wall);
  walls_changed_ = true;
}

/// Calls f(y, z) for every row of a wall.
template <class F>
void CoverMap::each_row(const Wall& wall, F&& f) {
  for (int z = wall.from[2]; z < wall.to[2]; ++z)
    for (int y = wall.from[1]; y < wall.to[1]; ++y) f(y, z);
}

/// Counts a solid in blocks of row (y, z); `share` holds the number until places are given.
void CoverMap::count(int y, int z, int first_block, int blocks) {
  Entry* entries = const_cast<Entry*>(&entry(y, z, first_block));
  for (int k = 0; k < blocks; ++k) ++entries[k].share;
}

/// Records are numbered in the order in which a sweep meets them: it then reads them one after
/// another.
void CoverMap::place_blocks() {
  std::fill(index_.begin(), index_.end(), Entry{});
  for (const Footprint& footprint : footprints_)
    for (const auto& span : footprint.spans()) count(span.y, span.z, span.block, span.blocks);
  for (const Wall& wall : walls_)
    each_row(wall, [&](int y, int z) {
      const int first = wall.from[0] / kPackWidth;
      count(y, z, first, (wall.to[0] - 1) / kPackWidth - first + 1);
    });
  records_ = 0;
  shares_.clear();
  for (Entry& e : index_) {
    if (e.share < 0) continue;
    e.record = records_++;
    const bool alone = e.share == 0;
    e.share = alone ? -1 : static_cast<std::int32_t>(shares_.size());
    if (!alone) shares_.push_back({{}, e.record});
  }
  lanes_.resize(static_cast<std::size_t>(records_) * size_);
  for (const Wall& wall : walls_)  // a block may hold fluid beside the wall
    each_row(wall, [&](int y, int z) {
      for (int b = wall.from[0] / kPackWidth; b <= (wall.to[0] - 1) / kPackWidth; ++b)
        if (const Entry& e = entry(y, z, b); e.share < 0)
          std::fill_n(lanes(e.record), size_, Lanes{});
    });
}

/// Records of blocks that the body has for itself, complete.
template <int D>
void CoverMap::write(const Body& body, const Footprint& footprint) {
  for (const auto& span : footprint.spans())
    for (int k = 0; k < span.blocks; ++k) {
      const Entry& e = entry(span.y, span.z, span.block + k);
      if (e.share >= 0) continue;
      auto& b = *reinterpret_cast<CoverBlock<D>*>(lanes(e.record));
      const Pack eps = load<Pack>(&footprint.fractions()[span.eps + k * kPackWidth]);
      const Velocity<D> u(body, span, k);
      const int skipped = k * kPackWidth;
      store(b.weight.data(), weight_(eps));
      store(b.layer.data(), layer_of(eps, span.core_begin - skipped, span.core_end - skipped));
      for (int a = 0; a < D; ++a) store(b.u[a].data(), u.at[a]);
    }
}

void CoverMap::begin_shared() {
  for (Share& s : shares_) {
    s.eps.fill(0.0);
    lanes(s.record)[1].fill(1.0);
    for (int a = 0; a < d_; ++a) velocity(s.record)[a].fill(0.0);
  }
}

/// Adds a body to the records of blocks that it shares: sums weighted with ε.
template <int D>
void CoverMap::share(const Body& body, const Footprint& footprint) {
  for (const auto& span : footprint.spans())
    for (int k = 0; k < span.blocks; ++k) {
      const Entry& e = entry(span.y, span.z, span.block + k);
      if (e.share < 0) continue;
      auto& b = *reinterpret_cast<CoverBlock<D>*>(lanes(e.record));
      Lanes& sum = shares_[e.share].eps;
      const Pack eps = load<Pack>(&footprint.fractions()[span.eps + k * kPackWidth]);
      const Velocity<D> u(body, span, k);
      const int skipped = k * kPackWidth;
      const Pack layer = layer_of(eps, span.core_begin - skipped, span.core_end - skipped);
      using std::min;
      store(b.layer.data(), min(pack(b.layer), layer));
      store(sum.data(), pack(sum) + eps);
      for (int a = 0; a < D; ++a) store(b.u[a].data(), pack(b.u[a]) + eps * u.at[a]);
    }
}

void CoverMap::finish_shared() {
  for (const Share& s : shares_) {
    Lanes &weight = lanes(s.record)[0], &layers = lanes(s.record)[1];
    const Pack eps = pack(s.eps);
    Pack scale(0.0), layer = pack(layers);
    where(eps > Pack(0.0), scale) = Pack(1.0) / eps;
    using std::min;
    where(eps >= Pack(kWhole), layer) = min(layer, Pack(0.0));
    for (int a = 0; a < d_; ++a) {
      Lanes& u = velocity(s.record)[a];
      store(u.data(), scale * pack(u));
    }
    store(weight.data(), weight_(eps));
    store(layers.data(), layer);
  }
}

/// A wall cell takes no part in what the bodies do: full bounce-back, whatever else is in the cell.
void CoverMap::write(const Wall& wall) {
  each_row(wall, [&](int y, int z) {
    for (int x = wall.from[0]; x < wall.to[0]; ++x) {
      const Entry& e = entry(y, z, x / kPackWidth);
      const int lane = x % kPackWidth;
      if (e.share >= 0) shares_[e.share].eps[lane] += 1.0;
      lanes(e.record)[0][lane] = lanes(e.record)[1][lane] = 1.0;
      for (int a = 0; a < d_; ++a) velocity(e.record)[a][lane] = 0.0;
    }
  });
}

template <int D>
BodyLoad CoverMap::load_of(const Footprint& footprint) const {
  Pack sum[D], torque[2 * D - 3];
  for (Pack& s : sum) s = Pack(0.0);
  for (Pack& t : torque) t = Pack(0.0);
  for (const auto& span : footprint.spans())
    for (int k = 0; k < span.blocks; ++k) {
      const Entry& e = entry(span.y, span.z, span.block + k);
      Pack f[D];
      for (int a = 0; a < D; ++a) f[a] = pack(force(e.record)[a]);
      if (e.share >= 0) {
        const Pack eps = load<Pack>(&footprint.fractions()[span.eps + k * kPackWidth]);
        Pack part(0.0);
        where(eps > Pack(0.0), part) = eps / pack(shares_[e.share].eps);
        for (Pack& component : f) component *= part;
      }
      for (int a = 0; a < D; ++a) sum[a] += f[a];
      const Pack x = Pack(span.arm_x + k * kPackWidth) + lane_numbers();
      torque[0] += x * f[1] - Pack(span.arm_y) * f[0];  // about z
      if constexpr (D == 3) {
        torque[1] += Pack(span.arm_y) * f[2] - Pack(span.arm_z) * f[1];
        torque[2] += Pack(span.arm_z) * f[0] - x * f[2];
      }
    }
  using std::experimental::reduce;
  if constexpr (D == 2)
    return {{reduce(sum[0]), reduce(sum[1])}, {0.0, 0.0, reduce(torque[0])}};
  else
    return {{reduce(sum[0]), reduce(sum[1]), reduce(sum[2])},
            {reduce(torque[1]), reduce(torque[2]), reduce(torque[0])}};
}

std::vector<BodyLoad> CoverMap::loads() const {
  std::vector<BodyLoad> result(bodies_.size());
  const auto n = static_cast<std::ptrdiff_t>(bodies_.size());
#pragma omp parallel for schedule(static) if (bodies_.size() >= kManyBodies)
  for (std::ptrdiff_t d = 0; d < n; ++d)
    result[d] = d_ == 2 ? load_of<2>(footprints_[d]) : load_of<3>(footprints_[d]);
  return result;
}

double CoverMap::solid_fraction(int x, int y, int z) const {
  const Entry& e = entry(y, z, x / kPackWidth);
  const int lane = x % kPackWidth;
  if (e.record < 0) return 0.0;
  if (e.share >= 0) return std::min(1.0, shares_[e.share].eps[lane]);
  return weight_.fraction(lanes(e.record)[0][lane]);
}

std::size_t CoverMap::bytes() const {
  return index_.size() * sizeof index_[0] + lanes_.size() * sizeof(Lanes) +
         shares_.size() * sizeof(Share);
}

}  // namespace lbm
