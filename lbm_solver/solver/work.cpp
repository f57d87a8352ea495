// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/work.h"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

namespace lbm {
namespace {

constexpr int kBlock = 8;  // cells of a SIMD block along x

/// What a cell of a covered block costs beyond one of fluid, where its body rests and where it
/// moves: between what balance_benchmark shows of loose and of dense packings (docs/parallel.md).
struct Surplus {
  double at_rest, moving;
};
constexpr Surplus kFlat{2.75, 4.5}, kSpatial{0.5, 1.0};  // sums are exact: alike on all ranks

double surplus_of(const Fluid& fluid, int from, int to, int y, int z) {
  const Surplus& more = fluid.lattice().D == 2 ? kFlat : kSpatial;
  double most = 0.0;
  for (int x = from; x < to; ++x) {
    if (fluid.solid_fraction(x, y, z) == 0.0) continue;
    const bool moves = !fluid.cover() || !fluid.cover()->cell(x, y, z).velocity.isZero();
    most = std::max(most, moves ? more.moving : more.at_rest);
    if (moves) break;
  }
  return most;
}

constexpr const char* kAxes[] = {"x", "y", "z"};

}  // namespace

LayerWork work_of(const Fluid& fluid) {
  LayerWork work;
  const Block& mine = fluid.cells();
  for (int a = 0; a < 3; ++a)
    work[a].assign(static_cast<std::size_t>(fluid.domain().cells()[a]), 0.0);
  for (int z = 0; z < mine.size[2]; ++z)
    for (int y = 0; y < mine.size[1]; ++y)
      for (int x = 0; x < mine.size[0]; x += kBlock) {
        const int to = std::min(x + kBlock, mine.size[0]);
        const double cost = fluid.has_solids() ? 1.0 + surplus_of(fluid, x, to, y, z) : 1.0;
        for (int k = x; k < to; ++k) work[0][mine.begin[0] + k] += cost;
        work[1][mine.begin[1] + y] += cost * (to - x);
        work[2][mine.begin[2] + z] += cost * (to - x);
      }
  for (auto& axis : work) fluid.ranks().sum(axis);
  return work;
}

Record save(const LayerWork& work) {
  Record record;
  for (int a = 0; a < 3; ++a) record.set(kAxes[a], work[a]);
  return record;
}

LayerWork load_work(const Record& record, const Domain& domain) {
  LayerWork work;
  for (int a = 0; a < 3; ++a)
    work[a] = record.list<double>(kAxes[a], static_cast<std::size_t>(domain.cells()[a]));
  return work;
}

LayerWork first_work(const Scene& scene, const Plan& plan, const Decomposition& ranks) {
  Fluid fluid = make_fluid(scene, plan, ranks);
  if (!scene.particles || scene.particles->start.empty() || !fluid.has_solids())
    return work_of(fluid);
  std::vector<Body> bodies = obstacle_bodies(scene, plan);
  std::int64_t id = 0;
  for (const Vec3& centre : scene.particles->start)
    bodies.push_back({++id, plan.units.to_lattice_position(centre),
                      0.5 * scene.particles->diameter.hi / plan.units.dx, Vec3(1e-3, 0.0), Spin()});
  fluid.place(bodies);
  return work_of(fluid);
}

Decomposition of_equal_work(const Decomposition& ranks, const LayerWork& work) {
  Cuts cuts;
  for (int a = 0; a < 3; ++a) cuts[a] = cuts_of_equal_sums(work[a], ranks.grid()[a]);
  return {ranks.domain(), ranks.comm(), ranks.grid(), cuts};
}

double imbalance(const Decomposition& ranks, const LayerWork& work) {
  double product = 1.0;
  for (int a = 0; a < 3; ++a) {
    double most = 0.0, all = 0.0;
    const std::vector<int>& cuts = ranks.cuts()[a];
    for (std::size_t p = 0; p + 1 < cuts.size(); ++p) {
      double sum = 0.0;
      for (int i = cuts[p]; i < cuts[p + 1]; ++i) sum += work[a][i];
      most = std::max(most, sum);
      all += sum;
    }
    product *= most * ranks.grid()[a] / all;
  }
  return product;
}

std::string cuts_text(const Decomposition& ranks) {
  std::string text;
  for (int a = 0; a < 3; ++a) {
    const std::vector<int>& cuts = ranks.cuts()[a];
    if (cuts.size() <= 2) continue;
    text += fmt::format(", cut along {} at", kAxes[a]);
    for (std::size_t p = 1; p + 1 < cuts.size(); ++p) text += fmt::format(" {}", cuts[p]);
  }
  return text;
}

std::string describe_blocks(const Decomposition& ranks, const LayerWork& work) {
  const Decomposition equal(ranks.domain(), ranks.comm(), ranks.grid());
  return fmt::format("{}: about {:.2f} of the mean work for the busiest, {:.2f} in equal blocks",
                     cuts_text(ranks), imbalance(ranks, work), imbalance(equal, work));
}

}  // namespace lbm
