// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/cover_map.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "lbm_solver/base/contracts.h"
#include "lbm_solver/base/held_bytes.h"
#include "lbm_solver/immersed/clump_cover.h"
#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/immersed/mapped_radius.h"
#include "lbm_solver/immersed/moving_shape.h"

namespace lbm {
namespace {

constexpr std::int32_t kAtRest = 0;         // of the motions
constexpr std::ptrdiff_t kManyBodies = 64;  // from which on it pays to divide them among threads

// The list of footprints grows: copies would leave the index with blocks that are gone.
static_assert(std::is_nothrow_move_constructible_v<Footprint>);

/// Blocks of cells side by side of a row, and in which of the row's they are.
/// @param x    cell of the first cover
/// @param arm  of that cell
template <class Take>
void each_block(int x, const Vec3& arm, std::span<const double> cover, Take&& take) {
  const int end = x + static_cast<int>(cover.size());
  for (int b = x / kPackWidth; b * kPackWidth < end; ++b) {
    CoverBlock block{};
    const int first = b * kPackWidth;
    for (int at = std::max(x, first); at < std::min(end, first + kPackWidth); ++at)
      block.cover[at - first] = cover[at - x];
    if (std::ranges::all_of(block.cover, [](double c) { return c == 0.0; })) continue;
    block.arm[0] = static_cast<float>(arm.x() + (first - x));
    block.arm[1] = static_cast<float>(arm.y());
    block.arm[2] = static_cast<float>(arm.z());
    take(block, b);
  }
}

}  // namespace

struct CoverMap::Mover {
  std::unique_ptr<MovingShape> shape;
  std::size_t blocks;               // its own in fixed_
  std::vector<std::size_t> places;  // in the index, of each block
  std::vector<CoverBlock> far;      // of a drum what faces out: no part of its load
  std::vector<std::size_t> far_places;
  Vec3 off;  // from the pivot to the place on the grid that arms begin at
};

CoverMap::CoverMap(const Domain& domain, const Block& cells, const RadiusShift& shift)
    : domain_(domain),
      cells_(cells),
      shift_(shift),
      d_(domain.dimension()),
      blocks_per_row_((cells.size[0] + kPackWidth - 1) / kPackWidth),
      index_(static_cast<std::size_t>(blocks_per_row_) * cells.size[1] * cells.size[2] + kRowsEnd),
      motions_(1) {}
CoverMap::~CoverMap() = default;

namespace {

/// The bodies as they are mapped, those of each clump together: what each covers there depends on
/// the others, so if one moves, all are written anew.
class Clumps {
 public:
  Clumps(std::span<const Body> bodies, const RadiusShift& shift) {
    if (std::ranges::none_of(bodies, [](const Body& b) { return b.carrier != 0; })) return;
    for (std::size_t d = 0; d < bodies.size(); ++d) {
      mapped_.push_back(bodies[d]);
      mapped_.back().radius = mapped_radius(shift, bodies[d].radius, bodies[d].hollow);
      if (bodies[d].carrier != 0) members_[bodies[d].carrier].push_back(d);
    }
  }
  bool none() const { return members_.empty(); }

  /// Where a body has moved, looks at the others of its clump as if they had. @return  one needs
  /// other spans
  bool move_together(std::vector<Footprint>& footprints, std::vector<Footprint::Change>& change,
                     const Domain& domain, const Block& cells) const {
    bool other_spans = false;
    for (const auto& [carrier, members] : members_) {
      const auto moved = [&](std::size_t d) { return change[d] != Footprint::Change::None; };
      if (std::ranges::none_of(members, moved)) continue;
      for (const std::size_t d : members) {
        if (moved(d)) continue;
        Body elsewhere = mapped_[d];
        elsewhere.radius *= 0.5;  // only a body that differs is looked at
        footprints[d].look(elsewhere, domain, cells);
        change[d] = footprints[d].look(mapped_[d], domain, cells);
        other_spans = other_spans || change[d] == Footprint::Change::Spans;
      }
    }
    return other_spans;
  }

  /// Writes a footprint that was looked at; of a clump less than what those before it cover.
  void write(Footprint& footprint, std::size_t d, const Domain& domain) const {
    footprint.write();
    if (mapped_.empty() || mapped_[d].carrier == 0) return;
    std::vector<Body> before;
    for (const std::size_t other : members_.at(mapped_[d].carrier))
      if (other < d) before.push_back(mapped_[other]);
    if (!before.empty()) take_union(footprint, mapped_[d], before, domain);
  }

 private:
  std::vector<Body> mapped_;
  std::map<std::int32_t, std::vector<std::size_t>> members_;
};

}  // namespace

void CoverMap::update(std::span<const Body> bodies) {
  for (std::size_t d = bodies.size(); d < footprints_.size(); ++d) unlink(footprints_[d]);
  footprints_.resize(bodies.size());
  const std::size_t first = 1 + movers_.size();
  motions_.resize(first + bodies.size());
  const Clumps clumps(bodies, shift_);
  carriers_.clear();
  if (!clumps.none()) {
    carriers_.assign(first, 0);
    for (const Body& b : bodies) carriers_.push_back(b.carrier);
  }
  const auto n = static_cast<std::ptrdiff_t>(bodies.size());
  std::vector<Footprint::Change> change(bodies.size());
  bool other_spans = false;
#pragma omp parallel for schedule(static) reduction(|| : other_spans) if (n >= kManyBodies)
  for (std::ptrdiff_t d = 0; d < n; ++d) {
    motions_[first + d] = {bodies[d].velocity, bodies[d].spin};
    Body mapped = bodies[d];
    mapped.radius = mapped_radius(shift_, mapped.radius, mapped.hollow);
    change[d] = footprints_[d].look(mapped, domain_, cells_);
    if (change[d] == Footprint::Change::Fractions && bodies[d].carrier == 0) footprints_[d].write();
    other_spans = other_spans || change[d] == Footprint::Change::Spans;
  }
  if (!clumps.none()) {
    other_spans = clumps.move_together(footprints_, change, domain_, cells_) || other_spans;
    for (std::ptrdiff_t d = 0; d < n; ++d)
      if (bodies[d].carrier != 0 && change[d] == Footprint::Change::Fractions)
        clumps.write(footprints_[d], static_cast<std::size_t>(d), domain_);
  }
  if (!other_spans) return;
  const auto other = [&](std::ptrdiff_t d) { return change[d] == Footprint::Change::Spans; };
  for (std::ptrdiff_t d = 0; d < n; ++d)
    if (other(d)) unlink(footprints_[d]);
#pragma omp parallel for schedule(static) if (n >= kManyBodies)
  for (std::ptrdiff_t d = 0; d < n; ++d)
    if (other(d)) clumps.write(footprints_[d], static_cast<std::size_t>(d), domain_);
  for (std::ptrdiff_t d = 0; d < n; ++d)
    if (other(d)) link(footprints_[d], static_cast<std::int32_t>(first + d));
}

void CoverMap::add_wall(const Cell3& from, const Cell3& to) {
  walls_.push_back(fill_blocks({CellBox{from, to}}));
}

void CoverMap::add(const Geometry& geometry) {
  fixed_.push_back(fill_blocks(geometry));
}

void CoverMap::add(std::unique_ptr<MovingShape> shape) {
  if (!footprints_.empty()) throw std::logic_error("a mesh that moves comes before the bodies");
  fixed_.emplace_back();
  movers_.push_back({std::move(shape), fixed_.size() - 1, {}, {}, {}, {}});
  motions_.resize(1 + movers_.size());
}

void CoverMap::move(std::span<const Pose> poses) {
  BPLBM_EXPECT(poses.size() == movers_.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    Mover& mover = movers_[k];
    const bool other = mover.shape->look(poses[k]);
    mover.off = mover.shape->centre() - poses[k].centre();
    if (d_ == 2) mover.off.z() = 0.0;
    motions_[1 + k] = {poses[k].velocity + poses[k].spin.cross(mover.off), poses[k].spin};
    if (!other) continue;
    std::vector<CoverBlock>& blocks = fixed_[mover.blocks];
    for (std::size_t i = 0; i < blocks.size(); ++i) unlink(mover.places[i], blocks[i]);
    for (std::size_t i = 0; i < mover.far.size(); ++i) unlink(mover.far_places[i], mover.far[i]);
    for (auto* list : {&blocks, &mover.far}) list->clear();
    for (auto* list : {&mover.places, &mover.far_places}) list->clear();
    const auto motion = static_cast<std::int32_t>(1 + k);
    mover.shape->map(domain_, cells_, [&](const CoverSpan& span) {
      const auto put = [&](std::span<const double> part, std::int32_t motion_of_it,
                           std::vector<CoverBlock>& to, std::vector<std::size_t>& at) {
        each_block(span.x, span.arm, part, [&](const CoverBlock& block, int b) {
          to.push_back(block);
          to.back().motion = motion_of_it;
          at.push_back(place(span.y, span.z, b));
        });
      };
      put(span.cover, motion, blocks, mover.places);
      put(span.far, motion, mover.far, mover.far_places);
      put(span.still, kAtRest, blocks, mover.places);
    });
    for (std::size_t i = 0; i < blocks.size(); ++i) insert(index_[mover.places[i]], blocks[i]);
    for (std::size_t i = 0; i < mover.far.size(); ++i)
      insert(index_[mover.far_places[i]], mover.far[i]);
  }
}

/// The blocks that a solid at rest covers, linked.
std::vector<CoverBlock> CoverMap::fill_blocks(const Geometry& geometry) {
  const Vec3 centre = (geometry.centre() / kSnap).array().round().matrix() * kSnap;
  const auto& begin = cells_.begin;
  std::vector<CoverBlock> blocks;
  std::vector<std::size_t> places;
  std::vector<double> cover;
  fill(geometry, domain_, cells_, shift_, [&](const FractionSpan& span) {
    const auto& [x, y, z, fractions] = span;
    cover.assign(fractions.begin(), fractions.end());
    for (double& c : cover)
      if (c >= kWhole) c = kWall;
    const Vec3 arm(x + begin[0] + 0.5 - centre.x(), y + begin[1] + 0.5 - centre.y(),
                   d_ == 3 ? z + begin[2] + 0.5 - centre.z() : 0.0);
    each_block(x, arm, cover, [&](const CoverBlock& block, int b) {
      blocks.push_back(block);
      places.push_back(place(span.y, span.z, b));
    });
  });
  blocks.shrink_to_fit();  // before the index points at them
  for (std::size_t k = 0; k < blocks.size(); ++k) insert(index_[places[k]], blocks[k]);
  return blocks;
}

/// Blocks with several solids list them in the order of the bodies, walls first: what a run has
/// gone through before leaves no trace in a sum.
void CoverMap::insert(CoverBlock*& at, CoverBlock& block) {
  CoverBlock** here = &at;
  while (*here && (*here)->motion <= block.motion) here = &(*here)->next;
  block.next = *here;
  *here = &block;
}

void CoverMap::link(Footprint& footprint, std::int32_t motion) {
  for (const auto& span : footprint.spans())
    for (int k = 0; k < span.blocks; ++k) {
      CoverBlock& block = footprint.blocks()[span.first + k];
      block.motion = motion;
      insert(index_[place(span.y, span.z, span.block + k)], block);
    }
}

void CoverMap::unlink(Footprint& footprint) {
  for (const auto& span : footprint.spans())
    for (int k = 0; k < span.blocks; ++k)
      unlink(place(span.y, span.z, span.block + k), footprint.blocks()[span.first + k]);
}

void CoverMap::unlink(std::size_t place, CoverBlock& block) {
  CoverBlock** here = &index_[place];
  while (*here != &block) here = &(*here)->next;
  *here = block.next;
}

/// What a solid's fractions count in a block that it shares: 1, or so much less that those of its
/// clump add up to a whole cell.
Pack CoverMap::part_of_union(const CoverBlock& first, const CoverBlock& block) const {
  const std::int32_t carrier = carriers_[block.motion];
  Pack sum(0.0);
  if (carrier == 0) return Pack(1.0);
  for (const CoverBlock* other = &first; other; other = other->next)
    if (carriers_[other->motion] == carrier) sum += fraction_of(load<Pack>(other->cover.data()));
  Pack part(1.0);
  where(sum > Pack(1.0), part) = Pack(1.0) / sum;
  return part;
}

template <int D>
CoverMap::Shared<D> CoverMap::merge(const CoverBlock& first) const {
  Shared<D> all;
  for (Pack& u : all.u) u = Pack(0.0);
  Pack sum(0.0);
  Pack::mask_type core(false), wall(false);
  for (const CoverBlock* block = &first; block; block = block->next) {
    const Pack cover = load<Pack>(block->cover.data());
    Pack eps = fraction_of(cover);
    if (!carriers_.empty()) eps *= part_of_union(first, *block);
    core = core || cover == Pack(kCore);
    wall = wall || cover == Pack(kWall);
    sum += eps;
    Pack u[D];
    velocity_in<D>(*block, motion(*block), u);
    for (int a = 0; a < D; ++a) all.u[a] += eps * u[a];
  }
  all.scale = Pack(0.0);
  where(sum > Pack(0.0), all.scale) = Pack(1.0) / sum;
  all.cover = fraction_of(sum);
  where(core, all.cover) = Pack(kCore);
  where(wall, all.cover) = Pack(kWall);
  for (Pack& u : all.u) {
    u *= all.scale;
    where(wall, u) = Pack(0.0);
  }
  return all;
}

template <int D>
void CoverMap::split(CoverBlock& first, const Pack& scale, const Pack (&force)[D]) const {
  for (CoverBlock* block = &first; block; block = block->next) {
    Pack part = scale * fraction_of(load<Pack>(block->cover.data()));
    if (!carriers_.empty()) part *= part_of_union(first, *block);
    Pack f[D];
    for (int a = 0; a < D; ++a) f[a] = part * force[a];
    keep_force<D>(*block, f);
  }
}

template CoverMap::Shared<2> CoverMap::merge<2>(const CoverBlock&) const;
template CoverMap::Shared<3> CoverMap::merge<3>(const CoverBlock&) const;
template void CoverMap::split<2>(CoverBlock&, const Pack&, const Pack (&)[2]) const;
template void CoverMap::split<3>(CoverBlock&, const Pack&, const Pack (&)[3]) const;

template <int D>
BodyLoad CoverMap::load_of(std::span<const CoverBlock> blocks) {
  double force[3] = {}, torque[3] = {};
  for (const CoverBlock& b : blocks) {
    const auto [fx, fy, moment_y, fz, moment_z] = b.sums;
    const double x = b.arm[0], y = b.arm[1], z = b.arm[2];
    force[0] += fx;
    force[1] += fy;
    torque[2] += x * fy + moment_y - y * fx;
    if constexpr (D == 3) {
      force[2] += fz;
      torque[0] += y * fz - z * fy;
      torque[1] += z * fx - x * fz - moment_z;
    }
  }
  return {{force[0], force[1], force[2]}, {torque[0], torque[1], torque[2]}};
}

std::vector<BodyLoad> CoverMap::loads() const {
  std::vector<BodyLoad> result(footprints_.size());
  const auto n = static_cast<std::ptrdiff_t>(footprints_.size());
#pragma omp parallel for schedule(static) if (n >= kManyBodies)
  for (std::ptrdiff_t d = 0; d < n; ++d)
    result[d] = d_ == 2 ? load_of<2>(footprints_[d].blocks()) : load_of<3>(footprints_[d].blocks());
  return result;
}

std::vector<BodyLoad> CoverMap::fixed_loads() const {
  std::vector<BodyLoad> result;
  for (const auto& blocks : fixed_)
    result.push_back(d_ == 2 ? load_of<2>(blocks) : load_of<3>(blocks));
  for (const Mover& mover : movers_) {
    BodyLoad& load = result[mover.blocks];
    load.torque += mover.off.cross(load.force);
  }
  return result;
}

CoverMap::Cell CoverMap::cell(int x, int y, int z) const {
  const CoverBlock* first = row(y, z)[x / kPackWidth];
  if (!first) return {0.0, Vec3()};
  const int lane = x % kPackWidth;
  const auto of = [&](const auto& shared) {
    Cell cell{shared.cover[lane], Vec3()};
    for (int a = 0; a < d_; ++a) cell.velocity[a] = shared.u[a][lane];
    return cell;
  };
  return d_ == 2 ? of(merge<2>(*first)) : of(merge<3>(*first));
}

double CoverMap::solid_fraction(int x, int y, int z) const {
  double sum = 0.0;
  for (const CoverBlock* b = row(y, z)[x / kPackWidth]; b; b = b->next)
    sum += fraction_of(b->cover[x % kPackWidth]);
  return std::min(sum, 1.0);
}

std::size_t CoverMap::covered_blocks() const {
  return static_cast<std::size_t>(index_.size() - std::ranges::count(index_, nullptr));
}

std::size_t CoverMap::bytes() const {
  std::size_t bytes = held(index_) + held(motions_) + held(carriers_) + held(footprints_);
  for (const Footprint& f : footprints_) bytes += f.bytes();
  for (const auto* list : {&walls_, &fixed_}) {
    bytes += held(*list);
    for (const auto& solid : *list) bytes += held(solid);
  }
  for (const Mover& m : movers_)
    bytes +=
        sizeof(MovingShape) + m.shape->bytes() + held(m.places) + held(m.far) + held(m.far_places);
  return bytes + held(movers_);
}

}  // namespace lbm
