// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <type_traits>

#include "lbm_solver/base/simd.h"
#include "lbm_solver/immersed/solid_term.h"
#include "lbm_solver/solver/kernel.h"

namespace lbm {

/// A scene without solids: no covered collision, and none is asked for.
struct NoSolid {};

/// The sweep of one lattice, collision and solid term: every row through the same few lines, eight
/// cells at a time, the rest of a row one by one with the same source.
template <class Collision, class Term>
class RowKernel final : public Kernel {
  static constexpr bool kSolid = !std::is_same_v<Term, NoSolid>;
  using Covered = CoveredCollision<std::conditional_t<kSolid, Term, Holdych>>;

 public:
  explicit RowKernel(const CollisionParameters& p) : collide_(p) {}

  void sweep(Populations& f, const EsotericPull& stream, CoverMap* cover) const override {
#pragma omp parallel
    {
      flush_denormals();
#pragma omp for schedule(static)
      for (int y = 0; y < f.ny(); ++y) {
        const EsotericPull::Row row = stream.open(f, y);
        if constexpr (kSolid)
          sweep_row_with_solids(row, y, f.nx(), *cover);
        else
          sweep_row(row, 0, f.nx());
        stream.close(f, y);
      }
    }
  }

 private:
  /// Pure fluid from cell x to cell end.
  void sweep_row(const EsotericPull::Row& row, int x, int end) const {
    for (; x + kPackWidth <= end; x += kPackWidth) fluid<Pack>(row, x);
    for (; x < end; ++x) fluid<double>(row, x);
  }

  /// Runs of pure fluid between the covered blocks: the first loop never asks about solids.
  void sweep_row_with_solids(const EsotericPull::Row& row, int y, int n, CoverMap& cover) const {
    for (int b = 0; b < cover.blocks_per_row(); ++b) {
      const int next = cover.next_covered(y, b);
      sweep_row(row, b * kPackWidth, std::min(next * kPackWidth, n));
      if (next == cover.blocks_per_row()) return;
      covered_block(row, next * kPackWidth, n, *cover.block(y, next));
      b = next;
    }
  }

  [[gnu::noinline]] void covered_block(const EsotericPull::Row& row, int x, int n,
                                       CoverMap::Block& block) const {
    if (x + kPackWidth <= n) return covered<Pack>(row, x, block, 0);
    for (int lane = 0; x + lane < n; ++lane) covered<double>(row, x + lane, block, lane);
  }

  template <class V>
  [[gnu::always_inline]] void fluid(const EsotericPull::Row& row, int x) const {
    V f[D2Q9::Q];
    unroll<D2Q9::Q>([&](auto q) __attribute__((always_inline)) { f[q] = load<V>(row.in[q] + x); });
    collide_(f);
    unroll<D2Q9::Q>([&](auto q) __attribute__((always_inline)) { store(row.out[q] + x, f[q]); });
  }

  template <class V>
  [[gnu::always_inline]] void covered(const EsotericPull::Row& row, int x, CoverMap::Block& block,
                                      int lane) const {
    V f[D2Q9::Q];
    unroll<D2Q9::Q>([&](auto q) __attribute__((always_inline)) { f[q] = load<V>(row.in[q] + x); });
    const auto force = Covered::apply(f, collide_, load<V>(&block.weight[lane]),
                                      Layer<V>::of(load<V>(&block.layer[lane])),
                                      load<V>(&block.us[lane]), load<V>(&block.vs[lane]));
    unroll<D2Q9::Q>([&](auto q) __attribute__((always_inline)) { store(row.out[q] + x, f[q]); });
    store(&block.fx[lane], force.x);
    store(&block.fy[lane], force.y);
  }

  Collision collide_;
};

}  // namespace lbm
