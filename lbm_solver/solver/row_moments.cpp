// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/row_moments.h"

#include <algorithm>
#include <cmath>

#include "lbm_solver/base/simd.h"
#include "lbm_solver/collision/forcing.h"
#include "lbm_solver/collision/moments.h"
#include "lbm_solver/viscosity/local_viscosity.h"

namespace lbm {
namespace {

/// The row of one lattice and precision, a pack of cells at a time.
template <class L, class Real>
class MomentsOfRow {
 public:
  explicit MomentsOfRow(const RowMedium& medium)
      : medium_(medium), force_(medium.parameters), viscosity_(medium.parameters) {}

  void operator()(Populations& f, const EsotericPull& stream, int y, int z, std::span<double> rho,
                  const RowVelocity& u, std::span<double> solid) const {
    const auto row = stream.open<L, Real>(f, y, z);  // makes the ends ready; may be repeated
    CoverBlock* const* blocks = medium_.cover ? medium_.cover->row(y, z) : nullptr;
    const float* const eddies = medium_.eddies ? medium_.eddies->row(y, z) : nullptr;
    const auto cells = [&](int x, const auto& lanes) {
      Pack g[L::Q];
      unroll<L::Q>([&](auto q) { g[q] = lanes.load(row.in[q] + x); });
      const Moments<L, Pack> m = moments<L>(g);
      Vector<L, Pack> mean = velocity<L>(m, force_);
      Pack share(0.0);
      if (blocks && blocks[x / kPackWidth])
        share =
            mix(g, m, *blocks[x / kPackWidth], eddies ? lanes.load(eddies + x) : Pack(1.0), mean);
      lanes.store(&rho[x], m.drho + Pack(1.0));
      lanes.store(&solid[x], share);
      for (int a = 0; a < L::D; ++a) lanes.store(&u[a][x], mean[a]);
    };
    int x = 0;
    for (; x + kPackWidth <= f.nx(); x += kPackWidth) cells(x, AllLanes<Pack>());
    if (x < f.nx()) cells(x, FirstLanes<Pack>(f.nx() - x));
  }

 private:
  /// Mixes the solid's velocity into that of the cells of a covered block. @return its share
  Pack mix(const Pack (&g)[L::Q], const Moments<L, Pack>& m, const CoverBlock& block,
           const Pack& eddies, Vector<L, Pack>& mean) const {
    const auto solid = medium_.cover->merge<L::D>(block);
    Pack tau(medium_.parameters.tau);
    if (medium_.local_viscosity)
      tau = local_tau<L>(g, m, Pack(1.0) - fraction_of(solid.cover), eddies, viscosity_, force_);
    Pack share = medium_.share.of<L>(solid.cover, tau);
    where(solid.cover == Pack(0.0), share) = Pack(0.0);
    for (int a = 0; a < L::D; ++a)  // what is not finite stays so: 0 times it is not 0
      mean[a] = (Pack(1.0) - share) * mean[a] + share * solid.u[a];
    if (medium_.share.takes_ghost()) take_ghost(g, m, solid.cover, tau, mean);
    return share;
  }

  void take_ghost(const Pack (&g)[L::Q], const Moments<L, Pack>& m, const Pack& cover,
                  const Pack& tau, Vector<L, Pack>& mean) const {
    constexpr double r2 = OddGhost<L>::ratio2;
    Pack part = medium_.share.of_ghost<L>(cover, tau) / (m.drho + Pack(1.0));
    where(cover == Pack(0.0), part) = Pack(0.0);
    unroll<L::D>([&](auto a) {
      const Pack along_axis = g[2 * a + 1] - g[2 * a + 2];
      const Pack z = (along_axis - Pack(r2) * (m.j[a] - along_axis)) * Pack(1.0 / std::sqrt(r2));
      mean[a] -= part * z;
    });
  }

  const RowMedium& medium_;
  GuoForce<L> force_;
  LocalViscosity viscosity_;
};

}  // namespace

void row_moments(Populations& f, const EsotericPull& stream, int y, int z, const RowMedium& medium,
                 std::span<double> rho, const RowVelocity& u, std::span<double> solid) {
  const bool single = f.precision() == Precision::Single;
  const auto run = [&]<class L>(L) {
    if (single)
      MomentsOfRow<L, float>{medium}(f, stream, y, z, rho, u, solid);
    else
      MomentsOfRow<L, double>{medium}(f, stream, y, z, rho, u, solid);
  };
  switch (f.lattice().id) {
    case VelocitySet::D2Q9:
      return run(D2Q9());
    case VelocitySet::D3Q19:
      return run(D3Q19());
    case VelocitySet::D3Q27:
      return run(D3Q27());
  }
}

}  // namespace lbm
