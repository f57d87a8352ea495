// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <type_traits>

#include "lbm_solver/base/simd.h"
#include "lbm_solver/immersed/solid_term.h"
#include "lbm_solver/solver/kernel.h"

namespace lbm {

/// What happens in covered cells: nothing, in a scene without solids, and none is asked for.
struct NoSolids {
  explicit NoSolids(const KernelChoice&) {}
};
/// Or a collision with the solid.
struct CoveredCells {
  explicit CoveredCells(const KernelChoice& c)
      : collision(lbm::solid_term(c.solid_term, c.parameters.tau), c.weight) {}
  CoveredCollision collision;
};

/// Fetches a row ahead of its sweep into the second-level cache, population by population: in three
/// dimensions a row's nineteen streams are more than the hardware follows.
template <class L, class Real>
class RowPrefetch {
  static constexpr int kLine = 64 / sizeof(Real);

 public:
  /// @param ahead  numbers between the row and the one to fetch; 0: none
  RowPrefetch(const EsotericPull::Row<L, Real>& row, int n, std::ptrdiff_t ahead)
      : row_(&row), ahead_(ahead), lines_((n + kLine - 1) / kLine + 1), at_(row.in[0] + ahead) {}

  /// To be called for every pack of cells swept.
  [[gnu::always_inline]] void fetch(int lines) {
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

/// The sweep of one lattice, precision and collision, with or without solids: every row through the
/// same few lines, a pack of cells at a time, the rest of a row with the same source behind a mask.
/// Covered cells collide in double precision whatever the populations are stored in.
template <class Collision, class Solids, class Real>
class RowKernel final : public Kernel {
  using L = typename Collision::Set;
  using V = PackOf<Real>;
  using Row = EsotericPull::Row<L, Real>;
  static constexpr bool kSolids = std::is_same_v<Solids, CoveredCells>;
  static constexpr int kWidth = V::size();

 public:
  explicit RowKernel(const KernelChoice& c) : collide_(c.parameters), solids_(c) {}

  void sweep(Populations& f, const EsotericPull& stream, CoverMap* cover,
             const Rows& rows) const override {
    const int count = rows.size();
#pragma omp for schedule(static) nowait
    for (int r = 0; r < count; ++r) {
      const auto [y, z] = rows[r];
      const Row row = stream.open<L, Real>(f, y, z);
      const std::ptrdiff_t ahead = L::D == 3 && r + 1 < count ? f.stride() : 0;
      RowPrefetch<L, Real> prefetch(row, f.nx(), ahead);
      if constexpr (kSolids)
        sweep_row_with_solids(row, y, z, f.nx(), *cover, prefetch);
      else
        sweep_row(row, 0, f.nx(), prefetch);
      stream.close<L, Real>(f, y, z);
    }
  }

  void macroscopic(Populations& f, const EsotericPull& stream, int y, int z, const Vec3& half_force,
                   std::span<double> rho, const RowVelocity& u) const override {
    const Row row = stream.open<L, Real>(f, y, z);  // makes the ends ready; may be repeated
    const auto cells = [&](int x, const auto& lanes) {
      Pack g[L::Q];
      unroll<L::Q>([&](auto q) { g[q] = lanes.load(row.in[q] + x); });
      const Moments<L, Pack> m = moments<L>(g);
      const Pack inverse = Pack(1.0) / (m.drho + Pack(1.0));
      lanes.store(&rho[x], m.drho + Pack(1.0));
      for (int a = 0; a < L::D; ++a)
        lanes.store(&u[a][x], (m.j[a] + Pack(half_force[a])) * inverse);
    };
    int x = 0;
    for (; x + kPackWidth <= f.nx(); x += kPackWidth) cells(x, AllLanes<Pack>());
    if (x < f.nx()) cells(x, FirstLanes<Pack>(f.nx() - x));
  }

 private:
  using Prefetch = RowPrefetch<L, Real>;

  /// Pure fluid from cell x to cell end.
  [[gnu::always_inline]] void sweep_row(const Row& row, int x, int end, Prefetch& shared) const {
    Prefetch prefetch = shared;  // in registers
    for (; x + kWidth <= end; x += kWidth) {
      if constexpr (L::D == 3) prefetch.fetch(L::Q + 3);
      fluid(row, x, AllLanes<V>());
    }
    if (x < end) fluid(row, x, FirstLanes<V>(end - x));
    shared = prefetch;
  }

  /// Runs of pure fluid between the covered blocks: the first loop never asks about solids.
  void sweep_row_with_solids(const Row& row, int y, int z, int n, CoverMap& cover,
                             Prefetch& prefetch) const {
    const int blocks = cover.blocks_per_row();
    int next = cover.next_covered(y, z, 0);
    if (next == blocks) return sweep_row(row, 0, n, prefetch);
    for (int b = 0; b < blocks; next = cover.next_covered(y, z, b)) {
      if (next > b) sweep_row(row, b * kPackWidth, std::min(next * kPackWidth, n), prefetch);
      if (next == blocks) return;
      const int x = next * kPackWidth;
      if constexpr (L::D == 3) prefetch.fetch(L::Q + 3);
      CoverBlock<L::D>& block = *cover.block<L::D>(y, z, next);
      if (x + kPackWidth <= n)
        covered(row, x, block, AllLanes<Pack>());
      else
        covered(row, x, block, FirstLanes<Pack>(n - x));
      b = next + 1;
    }
  }

  template <class Access>
  [[gnu::always_inline]] void fluid(const Row& row, int x, const Access& lanes) const {
    V f[L::Q];
    unroll<L::Q>([&](auto q) __attribute__((always_inline)) { f[q] = lanes.load(row.in[q] + x); });
    collide_(f);
    unroll<L::Q>([&](auto q) __attribute__((always_inline)) { lanes.store(row.out[q] + x, f[q]); });
  }

  template <class Access>
  [[gnu::noinline]] void covered(const Row& row, int x, CoverBlock<L::D>& block,
                                 const Access& lanes) const {
    Pack f[L::Q];
    unroll<L::Q>([&](auto q) __attribute__((always_inline)) { f[q] = lanes.load(row.in[q] + x); });
    CoveredCollision::Cell<L, Pack> cell{
        load<Pack>(block.weight.data()), load<Pack>(block.layer.data()), {}};
    unroll<L::D>([&](auto a) __attribute__((always_inline)) {
      cell.us[a] = load<Pack>(block.u[a].data());
    });
    const Vector<L, Pack> force = solids_.collision.template apply<L>(f, collide_, cell);
    unroll<L::Q>([&](auto q) __attribute__((always_inline)) { lanes.store(row.out[q] + x, f[q]); });
    unroll<L::D>([&](auto a)
                     __attribute__((always_inline)) { store(block.force[a].data(), force[a]); });
  }

  Collision collide_;
  Solids solids_;
};

}  // namespace lbm
