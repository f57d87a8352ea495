// SPDX-License-Identifier: GPL-2.0-or-later
/// `mpirun -np 2 balance_benchmark`: steps of a packing that fills the lower half of a box, with
/// blocks of equal size and of equal work, in turns. Spheres or discs of ten cells, which rest or
/// move so that all are mapped anew in each step. In brackets what the lowest rank works over what
/// the highest does: the surplus of a covered block in solver/work.cpp is chosen by it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lbm_solver/solver/work.h"
#include "tests/performance/usage.h"

namespace {

using namespace lbm;

constexpr double kRadius = 5.0, kPi = 3.14159265358979;
constexpr int kRounds = 9, kSteps = 6;

/// How the bodies lie: on a square or cubic lattice, or there and in the middle of each cube.
struct Array {
  double pitch;
  bool middle;
};

/// Along the last axis it fills half of the box.
std::vector<Body> packing(const Domain& d, const Array& array, double speed) {
  std::vector<Body> bodies;
  const bool flat = d.dimension() == 2;
  const int nx = static_cast<int>(d.nx / array.pitch);
  const int ny = static_cast<int>((flat ? d.ny / 2 : d.ny) / array.pitch);
  const int nz = flat ? 1 : static_cast<int>(d.nz / 2 / array.pitch);
  for (int layer = 0; layer < (array.middle ? 2 : 1); ++layer)
    for (int i = 0; i < nx * ny * nz; ++i) {
      Body b;
      b.id = static_cast<std::int64_t>(bodies.size()) + 1;
      const double at = layer == 0 ? 0.5 : 1.0;
      b.centre = array.pitch * Vec3(i % nx + at, i / nx % ny + at, i / (nx * ny) + at);
      if (flat) b.centre.z() = 0.0;
      b.radius = kRadius;
      b.velocity.x() = speed;
      bodies.push_back(b);
    }
  return bodies;
}

/// A fluid with its packing, and the seconds that it took.
class Run {
 public:
  Run(const Decomposition& ranks, const KernelChoice& choice, std::vector<Body> bodies)
      : fluid_(ranks, choice), bodies_(std::move(bodies)) {
    fluid_.place(mine());
  }
  const Fluid& fluid() const { return fluid_; }

  double steps() {
    MPI_Barrier(MPI_COMM_WORLD);
    const double begin = MPI_Wtime(), waited = fluid_.waited();
    for (int s = 0; s < kSteps; ++s) {
      fluid_.place(mine());
      fluid_.step();
      fluid_.loads();
      for (Body& b : bodies_) b.centre += b.velocity;
    }
    worked_ += MPI_Wtime() - begin - (fluid_.waited() - waited);
    MPI_Barrier(MPI_COMM_WORLD);
    return MPI_Wtime() - begin;
  }
  /// Of the lowest rank over the highest. Collective.
  double lowest_over_highest() const {
    std::vector<double> all = fluid_.ranks().collect({worked_});
    return all.empty() ? 0.0 : all.front() / all.back();
  }

 private:
  /// Those that reach into this rank's cells, as the solid sends them.
  std::vector<Body> mine() const {
    const Block& cells = fluid_.cells();
    const int axis = fluid_.domain().dimension() - 1;
    std::vector<Body> some;
    for (const Body& b : bodies_)
      if (b.centre[axis] + kRadius + 2.0 > cells.begin[axis] &&
          b.centre[axis] - kRadius - 2.0 < cells.begin[axis] + cells.size[axis])
        some.push_back(b);
    return some;
  }

  Fluid fluid_;
  std::vector<Body> bodies_;
  double worked_ = 0.0;
};

void measure(const Domain& domain, const Array& array, double speed, int ranks) {
  const bool flat = domain.dimension() == 2;
  const KernelChoice choice{.solid_term = SolidTerm::LayeredResistance,
                            .parameters = {.tau = 0.7},
                            .lattice = flat ? VelocitySet::D2Q9 : VelocitySet::D3Q19};
  const Decomposition blocks(domain, MPI_COMM_WORLD,
                             flat ? Cell3{1, ranks, 1} : Cell3{1, 1, ranks});
  const std::vector<Body> bodies = packing(domain, array, speed);
  Run equal(blocks, choice, bodies);
  const LayerWork work = work_of(equal.fluid());
  Run balanced(of_equal_work(blocks, work), choice, bodies);
  std::vector<double> ratios;
  for (int round = 0; round < kRounds; ++round) {
    const double first = equal.steps();
    ratios.push_back(first / balanced.steps());
  }
  std::sort(ratios.begin(), ratios.end());
  const double before = equal.lowest_over_highest(), after = balanced.lowest_over_highest();
  const double covered = flat ? kPi * kRadius * kRadius : 4.0 / 3.0 * kPi * std::pow(kRadius, 3);
  const double half = 0.5 * domain.nx * domain.ny * domain.nz;
  if (blocks.rank() == 0)
    fmt::print(
        "{} {}{}, {:.0f} % of the half{}\n    {:.2f} × as fast (quartiles {:.2f} … {:.2f}; "
        "{:.2f} → {:.2f})\n",
        bodies.size(), flat ? "discs" : "spheres", speed > 0.0 ? "" : " at rest",
        100.0 * covered * static_cast<double>(bodies.size()) / half,
        describe_blocks(balanced.fluid().ranks(), work), ratios[kRounds / 2], ratios[kRounds / 4],
        ratios[kRounds - 1 - kRounds / 4], before, after);
}

}  // namespace

int main(int argc, char** argv) {
  if (bench::asks_for_help(argc, argv, "mpirun -np 2 balance_benchmark")) return 0;
  int level = 0, ranks = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const Domain box{96, 96, Side::Periodic, Side::Periodic, 128, Side::Wall};
  const Domain plane{1024, 1024, Side::Periodic, Side::Wall};
  for (const double speed : {0.02, 0.0}) {
    for (const Array& array : {Array{12.0, true}, Array{13.0, false}})
      measure(box, array, speed, ranks);
    for (const Array& array : {Array{10.2, false}, Array{13.0, false}})
      measure(plane, array, speed, ranks);
  }
  MPI_Finalize();
  return 0;
}
