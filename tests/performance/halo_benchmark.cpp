// SPDX-License-Identifier: GPL-2.0-or-later
/// `mpirun -np 2 halo_benchmark`: microseconds that an exchange of populations between ranks takes,
/// by cells along an edge and by the axis that is cut, D3Q19, both faces of each rank.
#include <fmt/format.h>

#include "lbm_solver/field/halo_exchange.h"
#include "tests/performance/usage.h"

namespace {

using namespace lbm;

void measure(int n, int axis, int ranks) {
  Cell3 grid{1, 1, 1}, cells{n, n, n};
  grid[axis] = ranks;
  cells[axis] = n * ranks;
  const Domain domain{cells[0], cells[1], Side::Periodic, Side::Periodic, cells[2], Side::Periodic};
  const Decomposition decomposition(domain, MPI_COMM_WORLD, grid);
  Populations f(lattice(VelocitySet::D3Q19), decomposition.cells().size);
  EsotericPull stream(decomposition.cells().faces);
  HaloExchange halo(decomposition, f);
  constexpr int warm = 20, count = 200;
  double start = 0.0;
  for (int k = 0; k < warm + count; ++k) {
    if (k == warm) start = MPI_Wtime();
    halo.begin(axis, f, stream);
    halo.finish(axis, f, stream);
    stream.advance();
  }
  const double spent = (MPI_Wtime() - start) / count;
  if (decomposition.rank() == 0)
    fmt::print(
        "{:>4}³ cells a rank, cut across {}: {:>8.1f} µs, {} messages, {} bytes, {:.2f} ns a "
        "byte\n",
        n, "xyz"[axis], 1e6 * spent, halo.messages(), halo.bytes(),
        1e9 * spent / static_cast<double>(halo.bytes()));
}

}  // namespace

int main(int argc, char** argv) {
  if (bench::asks_for_help(argc, argv, "mpirun -np 2 halo_benchmark")) return 0;
  MPI_Init(&argc, &argv);
  int ranks = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  if (ranks < 2) {
    fmt::print(stderr, "halo_benchmark | error | start several ranks: mpirun -np 2\n");
    MPI_Finalize();
    return 2;
  }
  for (const int n : {25, 50, 100})
    for (const int axis : {0, 1, 2}) measure(n, axis, ranks);
  MPI_Finalize();
  return 0;
}
