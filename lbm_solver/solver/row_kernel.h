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

/// The sweep of one lattice and collision, with or without solids: every row through the same few
/// lines, eight cells at a time, the rest of a row with the same source behind a mask.
template <class Collision, class Solids>
class RowKernel final : public Kernel {
  static constexpr bool kSolids = std::is_same_v<Solids, CoveredCells>;

 public:
  explicit RowKernel(const KernelChoice& c) : collide_(c.parameters), solids_(c) {}

  void sweep(Populations& f, const EsotericPull& stream, CoverMap* cover) const override {
#pragma omp for schedule(static) nowait
    for (int y = 0; y < f.ny(); ++y) {
      const EsotericPull::Row row = stream.open(f, y);
      if constexpr (kSolids)
        sweep_row_with_solids(row, y, f.nx(), *cover);
      else
        sweep_row(row, 0, f.nx());
      stream.close(f, y);
    }
  }

 private:
  /// Pure fluid from cell x to cell end.
  void sweep_row(const EsotericPull::Row& row, int x, int end) const {
    for (; x + kPackWidth <= end; x += kPackWidth) fluid(row, x, AllLanes());
    if (x < end) fluid(row, x, FirstLanes(end - x));
  }

  /// Runs of pure fluid between the covered blocks: the first loop never asks about solids.
  void sweep_row_with_solids(const EsotericPull::Row& row, int y, int n, CoverMap& cover) const {
    for (int b = 0; b < cover.blocks_per_row(); ++b) {
      const int next = cover.next_covered(y, b);
      sweep_row(row, b * kPackWidth, std::min(next * kPackWidth, n));
      if (next == cover.blocks_per_row()) return;
      const int x = next * kPackWidth;
      if (x + kPackWidth <= n)
        covered(row, x, *cover.block(y, next), AllLanes());
      else
        covered(row, x, *cover.block(y, next), FirstLanes(n - x));
      b = next;
    }
  }

  template <class Lanes>
  [[gnu::always_inline]] void fluid(const EsotericPull::Row& row, int x, const Lanes& lanes) const {
    Pack f[D2Q9::Q];
    unroll<D2Q9::Q>([&](auto q)
                        __attribute__((always_inline)) { f[q] = lanes.load(row.in[q] + x); });
    collide_(f);
    unroll<D2Q9::Q>([&](auto q)
                        __attribute__((always_inline)) { lanes.store(row.out[q] + x, f[q]); });
  }

  template <class Lanes>
  [[gnu::noinline]] void covered(const EsotericPull::Row& row, int x, CoverMap::Block& block,
                                 const Lanes& lanes) const {
    Pack f[D2Q9::Q];
    unroll<D2Q9::Q>([&](auto q)
                        __attribute__((always_inline)) { f[q] = lanes.load(row.in[q] + x); });
    const auto force =
        solids_.collision.apply(f, collide_,
                                CoveredCollision::Cell<Pack>{
                                    load<Pack>(block.weight.data()), load<Pack>(block.layer.data()),
                                    load<Pack>(block.us.data()), load<Pack>(block.vs.data())});
    unroll<D2Q9::Q>([&](auto q)
                        __attribute__((always_inline)) { lanes.store(row.out[q] + x, f[q]); });
    store(block.fx.data(), force.x);
    store(block.fy.data(), force.y);
  }

  Collision collide_;
  Solids solids_;
};

}  // namespace lbm
