// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>

#include "lbm_solver/base/simd.h"
#include "lbm_solver/immersed/resistance.h"
#include "lbm_solver/solver/kernel.h"

namespace lbm {

/// Fetches a row ahead of its sweep into the second-level cache, population by population: in three
/// dimensions a row's nineteen streams are more than the hardware follows. Populations that lie in
/// the caches are left alone: there the asking costs more than it gains.
template <class L, class Real>
class RowPrefetch {
  static constexpr int kLine = 64 / sizeof(Real);

 public:
  /// @param ahead  numbers between the row and the one to fetch; 0: none
  RowPrefetch(const EsotericPull::Row<L, Real>& row, int n, std::ptrdiff_t ahead)
      : row_(&row), ahead_(ahead), lines_((n + kLine - 1) / kLine + 1), at_(row.in[0] + ahead) {}

  /// To be called for every pack of cells swept.
  [[gnu::always_inline]] void fetch(int lines) {
    if (ahead_ == 0) return;
    for (int k = 0; k < lines; ++k) {
      __builtin_prefetch(at_, 1, 2);
      at_ += kLine;
      if (++line_ < lines_) continue;
      line_ = 0;
      if (q_ < L::Q - 1) ++q_;
      at_ = row_->in[q_] + ahead_;
    }
  }

 private:
  const EsotericPull::Row<L, Real>* row_;
  std::ptrdiff_t ahead_;
  int lines_, line_ = 0, q_ = 0;
  const Real* at_;
};

/// Fetches blocks of solids ahead of the sweep, which comes upon them in another order than that in
/// which they lie. A few blocks ahead: with a whole row they were gone again, and 40 % covered
/// cells took 2.3 times as long.
class CoverPrefetch {
  static constexpr int kFirst = 4, kOthers = 2;  // blocks ahead
  static_assert(kFirst <= CoverMap::kRowsEnd);

 public:
  explicit CoverPrefetch(CoverBlock* const* row) : row_(row) {}

  /// To be called before block b of the row is swept.
  [[gnu::always_inline]] void fetch(int b) {
    for (; at_ <= b + kFirst; ++at_) {
      if (row_[at_]) prefetch_bytes<sizeof(CoverBlock)>(row_[at_]);
      // what other solids have of a block is known where the first has come
      const CoverBlock* first = row_[at_ - kFirst + kOthers];
      if (first && first->next) prefetch_bytes<sizeof(CoverBlock)>(first->next);
    }
  }

 private:
  CoverBlock* const* row_;
  int at_ = kFirst - kOthers;
};

/// The sweep of one lattice, precision and collision: every row through the same few lines, a pack
/// of cells at a time, the rest of a row with the same source behind a mask. Covered cells of a
/// viscosity that depends on the shear rate collide in double precision whatever the populations
/// are stored in: the fourth powers of the stress there are beyond floats. Forces on solids are
/// always summed in double precision.
template <class Collision, class Real>
class RowKernel final : public Kernel {
  using L = typename Collision::Set;
  using V = PackOf<Real>;
  using Row = EsotericPull::Row<L, Real>;
  using Covered = std::conditional_t<Collision::local_viscosity, Pack, V>;  // pack of covered cells
  static constexpr int kWidth = V::size(), kCoveredWidth = Covered::size();
  static constexpr int kBlocks = kCoveredWidth / kPackWidth;  // of the cover map in such a pack

 public:
  explicit RowKernel(const KernelChoice& c) : collide_(c.parameters) {
    if (c.solid_term == SolidTerm::None) return;
    if (!by_resistance(c.solid_term)) {
      covered_.emplace(solid_term_rows(c.solid_term, c.parameters.tau),
                       ImmersedWeight(c.weight, c.parameters.tau), collide_);
      return;
    }
    if constexpr (Collision::fixed_magic)
      resistance_.emplace(c.solid_term, c.parameters);
    else
      throw std::invalid_argument("solid term '" + name_of(c.solid_term) +
                                  "' needs the collision trt");
  }

  void sweep(Populations& f, const EsotericPull& stream, CoverMap* cover, const EddyField* eddies,
             const Rows& rows) const override {
    const int count = rows.size();
    const std::ptrdiff_t to_next_row = f.beyond_caches() ? f.stride() : 0;
#pragma omp for schedule(static) nowait
    for (int r = 0; r < count; ++r) {
      const auto [y, z] = rows[r];
      const CellRow row{stream.open<L, Real>(f, y, z), eddies ? eddies->row(y, z) : nullptr};
      const std::ptrdiff_t ahead = r + 1 < count ? to_next_row : 0;
      RowPrefetch<L, Real> prefetch(row.populations, f.nx(), ahead);
      if (const int first = cover ? cover->next_covered(y, z, 0) : f.nx();
          first * kPackWidth >= f.nx())
        sweep_run(row, 0, f.nx(), prefetch);
      else
        sweep_row_with_solids(row, y, z, f.nx(), first, *cover, prefetch);
      stream.close<L, Real>(f, y, z);
    }
  }

 private:
  using Prefetch = RowPrefetch<L, Real>;
  struct CellRow {
    Row populations;
    const float* eddies;  ///< of an EddyField; null: none
  };
  using Blocks = std::array<CoverBlock*, kBlocks>;  // null: pure fluid, but for the first

  /// What solids that share a block have of it.
  struct Shares {
    bool shared;
    Pack scale;  ///< see CoverMap::Shared
  };

  /// Pure fluid from cell x to cell end.
  [[gnu::always_inline]] void sweep_run(const CellRow& row, int x, int end,
                                        Prefetch& shared) const {
    Prefetch prefetch = shared;  // in registers
    for (; x + kWidth <= end; x += kWidth) {
      if constexpr (L::D == 3) prefetch.fetch(L::Q + 3);
      fluid(row, x, AllLanes<V>());
    }
    if (x < end) fluid(row, x, FirstLanes<V>(end - x));
    shared = prefetch;
  }

  /// Runs of pure fluid between the covered blocks: inside a run nothing is asked about solids.
  /// @param next  the first covered block
  [[gnu::noinline]] void sweep_row_with_solids(const CellRow& row, int y, int z, int n, int next,
                                               CoverMap& cover, Prefetch& prefetch) const {
    const int blocks = cover.blocks_per_row();
    CoverPrefetch ahead(cover.row(y, z));
    for (int b = 0; b < blocks; next = cover.next_covered(y, z, b)) {
      if (next > b) sweep_run(row, b * kPackWidth, std::min(next * kPackWidth, n), prefetch);
      if (next == blocks) return;
      const int x = next * kPackWidth;
      if constexpr (L::D == 3) prefetch.fetch(L::Q + 3);
      const int end = std::min(next + kBlocks, blocks);
      ahead.fetch(end - 1);
      Blocks found = {};
      std::copy(cover.row(y, z) + next, cover.row(y, z) + end, found.begin());
      if (x + kCoveredWidth <= n)
        covered(row, x, cover, found, AllLanes<Covered>());
      else
        covered(row, x, cover, found, FirstLanes<Covered>(n - x));
      b = next + kBlocks;
    }
  }

  template <class Access>
  [[gnu::always_inline]] void fluid(const CellRow& row, int x, const Access& lanes) const {
    const Row& at = row.populations;
    V f[L::Q], eddies(1.0);
    unroll<L::Q>([&](auto q) __attribute__((always_inline)) { f[q] = lanes.load(at.in[q] + x); });
    if constexpr (Collision::local_viscosity)
      if (row.eddies) eddies = lanes.load(row.eddies + x);
    collide_(f, eddies);
    unroll<L::Q>([&](auto q) __attribute__((always_inline)) { lanes.store(at.out[q] + x, f[q]); });
  }

  template <class Access>
  [[gnu::always_inline]] void covered(const CellRow& row, int x, const CoverMap& cover,
                                      Blocks blocks, const Access& lanes) const {
    if constexpr (Collision::fixed_magic)
      if (resistance_) return covered(*resistance_, row, x, cover, blocks, lanes);
    covered(*covered_, row, x, cover, blocks, lanes);
  }

  template <class SolidCollision, class Access>
  [[gnu::noinline]] void covered(const SolidCollision& solid, const CellRow& row, int x,
                                 const CoverMap& cover, Blocks blocks, const Access& lanes) const {
    CoveredCell<L, Covered> cell;
    Shares shares[kBlocks];
    if constexpr (kBlocks == 1) {
      shares[0] = find_cover(cover, *blocks[0], cell);
    } else {
      CoveredCell<L, Pack> low, high = {Pack(0.0), {}};
      unroll<L::D>([&](auto a) __attribute__((always_inline)) { high.us[a] = Pack(0.0); });
      shares[0] = find_cover(cover, *blocks[0], low);
      if (blocks[1]) shares[1] = find_cover(cover, *blocks[1], high);
      cell.cover = JoinedPacks::join(low.cover, high.cover);
      unroll<L::D>([&](auto a) __attribute__((always_inline)) {
        cell.us[a] = JoinedPacks::join(low.us[a], high.us[a]);
      });
    }
    const Row& at = row.populations;
    Covered f[L::Q];
    unroll<L::Q>([&](auto q) __attribute__((always_inline)) { f[q] = lanes.load(at.in[q] + x); });
    if constexpr (Collision::local_viscosity)
      if (row.eddies) cell.eddies = lanes.load(row.eddies + x);
    const Vector<L, Covered> force = solid.template apply<L>(f, collide_, cell);
    unroll<L::Q>([&](auto q) __attribute__((always_inline)) { lanes.store(at.out[q] + x, f[q]); });
    if constexpr (kBlocks == 1) {
      keep(cover, *blocks[0], shares[0], force.at);
    } else {
      Pack low[L::D], high[L::D];
      unroll<L::D>([&](auto a) __attribute__((always_inline)) {
        low[a] = JoinedPacks::low(force[a]);
        high[a] = JoinedPacks::high(force[a]);
      });
      keep(cover, *blocks[0], shares[0], low);
      if (blocks[1]) keep(cover, *blocks[1], shares[1], high);
    }
  }

  /// Writes what covers the cells of a block.
  [[gnu::always_inline]] static Shares find_cover(const CoverMap& cover, const CoverBlock& block,
                                                  CoveredCell<L, Pack>& cell) {
    Shares shares;
    shares.shared = block.next;
    if (shares.shared) [[unlikely]] {
      const auto all = cover.merge<L::D>(block);
      shares.scale = all.scale;
      cell.cover = all.cover;
      std::copy_n(all.u, L::D, cell.us.at);
    } else {
      cell.cover = load<Pack>(block.cover.data());
      velocity_in<L::D>(block, cover.motion(block), cell.us.at);
    }
    return shares;
  }

  /// Gives the solids of a block the force on them.
  [[gnu::always_inline]] static void keep(const CoverMap& cover, CoverBlock& block,
                                          const Shares& shares, const Pack (&force)[L::D]) {
    if (shares.shared) [[unlikely]]
      cover.split<L::D>(block, shares.scale, force);
    else
      keep_force<L::D>(block, force);
  }

  Collision collide_;
  std::optional<CoveredCollision> covered_;
  std::optional<ResistanceCollision> resistance_;
};

}  // namespace lbm
