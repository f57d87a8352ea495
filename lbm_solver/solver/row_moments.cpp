// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/row_moments.h"

#include "lbm_solver/base/simd.h"
#include "lbm_solver/collision/equilibrium.h"

namespace lbm {
namespace {

template <class L, class Real>
void row_moments_of(Populations& f, const EsotericPull& stream, int y, int z,
                    const Vec3& half_force, std::span<double> rho, const RowVelocity& u) {
  const auto row = stream.open<L, Real>(f, y, z);  // makes the ends ready; may be repeated
  const auto cells = [&](int x, const auto& lanes) {
    Pack g[L::Q];
    unroll<L::Q>([&](auto q) { g[q] = lanes.load(row.in[q] + x); });
    const Moments<L, Pack> m = moments<L>(g);
    const Pack inverse = Pack(1.0) / (m.drho + Pack(1.0));
    lanes.store(&rho[x], m.drho + Pack(1.0));
    for (int a = 0; a < L::D; ++a) lanes.store(&u[a][x], (m.j[a] + Pack(half_force[a])) * inverse);
  };
  int x = 0;
  for (; x + kPackWidth <= f.nx(); x += kPackWidth) cells(x, AllLanes<Pack>());
  if (x < f.nx()) cells(x, FirstLanes<Pack>(f.nx() - x));
}

}  // namespace

void row_moments(Populations& f, const EsotericPull& stream, int y, int z, const Vec3& half_force,
                 std::span<double> rho, const RowVelocity& u) {
  const bool single = f.precision() == Precision::Single;
  const auto run = [&]<class L>(L) {
    if (single)
      row_moments_of<L, float>(f, stream, y, z, half_force, rho, u);
    else
      row_moments_of<L, double>(f, stream, y, z, half_force, rho, u);
  };
  switch (f.lattice().Q) {
    case 9:
      return run(D2Q9());
    case 19:
      return run(D3Q19());
    default:
      return run(D3Q27());
  }
}

}  // namespace lbm
