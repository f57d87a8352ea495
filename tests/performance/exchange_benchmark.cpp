// SPDX-License-Identifier: MIT
/// `mpirun -np 2 exchange_benchmark` (or any even number of ranks, half of them fluid):
/// microseconds that an exchange takes, states there and loads back, without any physics, by number
/// of particles, and what travels: each particle to the slabs of the box that it touches.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>

#include "protocol/transport/mpi_channel.h"
#include "protocol/wire/routing.h"
#include "protocol/wire/session.h"
#include "tests/performance/usage.h"

namespace {

using namespace protocol;

constexpr double kTimeout = 60.0, kRadius = 0.005;
constexpr std::int64_t kStride = 104729;  // a prime

/// Along an edge of the box; so few that no centre lies in another particle.
std::int64_t sites_for(int particles) {
  return particles > 250000 ? 128 : 64;
}

/// Most memory that this process has had [MB].
double peak() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return 1.024e-3 * std::strtod(line.c_str() + 6, nullptr);
  return 0.0;
}

/// A fluid rank holds a slab of the unit cube.
Hello hello(Role role, int rank, int ranks) {
  Hello h;
  h.role = role;
  h.dimension = 3;
  h.box_hi = h.subdomain_hi = {1.0, 1.0, 1.0};
  h.subdomain_lo[2] = static_cast<double>(rank) / ranks;
  h.subdomain_hi[2] = static_cast<double>(rank + 1) / ranks;
  h.reach = 0.4 * kRadius;
  h.step = 1.0;
  return h;
}

void fluid(Channel& channel, int rank, int ranks, int intervals) {
  FluidSession session(channel, hello(Role::Fluid, rank, ranks), kTimeout);
  session.agree();
  std::vector<Load> loads;
  for (int k = 0; k < intervals; ++k) {
    const Arrival& arrival = session.receive();
    loads.resize(arrival.particles.size());
    for (std::size_t i = 0; i < loads.size(); ++i)
      loads[i] = {arrival.particles[i].state.id, {1.0, 2.0, 3.0}, {}};
    session.answer(loads);
  }
  session.receive();
}

void solid(Channel& channel, int rank, int ranks, int particles, int intervals) {
  SolidSession session(channel, kTimeout);
  session.agree(hello(Role::Solid, rank, ranks));
  std::mt19937 random(rank);
  std::uniform_real_distribution<double> at(0.0, 1.0);
  const int mine = (particles + ranks - 1 - rank) / ranks;
  std::vector<State> states(mine);
  std::vector<Shape> shapes(mine);
  double copies = 0.0;
  const std::int64_t sites = sites_for(particles);
  for (int i = 0; i < mine; ++i) {
    const std::int64_t id = rank + static_cast<std::int64_t>(i) * ranks;
    // places spread over the box, in no order, none in another's: on a grid, a little off its sites
    const std::int64_t site = id * kStride % (sites * sites * sites);
    const auto place = [&](std::int64_t index) {
      return (static_cast<double>(index % sites) + 0.5 + 0.2 * (at(random) - 0.5)) /
             static_cast<double>(sites);
    };
    states[i] = {id, {place(site), place(site / sites), place(site / sites / sites)}, {}, {}};
    shapes[i] = {id, kRadius, 1.0, 0.4 * kRadius * kRadius, 1};
    for (int f = 0; f < ranks; ++f)
      copies += touches(hello(Role::Fluid, f, ranks), states[i].x, kRadius) ? 1.0 : 0.0;
  }
  const int warm = intervals / 5;
  auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < intervals; ++k) {
    if (k == warm) start = std::chrono::steady_clock::now();
    session.exchange({k, 0.0, kContinue}, states, shapes);
  }
  const std::chrono::duration<double, std::micro> spent = std::chrono::steady_clock::now() - start;
  session.exchange({intervals, 0.0, kLast}, states, shapes);
  if (rank == 0)
    fmt::print(
        "{:>8} particles {:>10.1f} µs an exchange; a solid rank: {} messages, {:.0f} bytes, {:.0f} "
        "MB of memory so far\n",
        particles, spent.count() / (intervals - warm), 2 * ranks,
        copies * static_cast<double>(sizeof(State) + sizeof(Load)), peak());
}

}  // namespace

int main(int argc, char** argv) {
  if (bench::asks_for_help(argc, argv,
                           "mpirun -np 2 exchange_benchmark, or any even number of ranks"))
    return 0;
  MPI_Init(&argc, &argv);
  int rank = 0, size = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (size % 2 != 0) {
    if (rank == 0)
      fmt::print(stderr, "exchange_benchmark | error | start an even number: mpirun -np 2\n");
    MPI_Finalize();
    return 2;
  }
  const int ranks = size / 2;
  const Role role = rank < ranks ? Role::Fluid : Role::Solid;
  for (const auto& [particles, intervals] :
       {std::pair{1, 20000}, {500, 20000}, {10000, 1000}, {100000, 100}, {1000000, 10}}) {
    World world = connect(role);
    const auto channel = make_mpi_channel(world, role);
    if (role == Role::Fluid)
      fluid(*channel, rank, ranks, intervals);
    else
      solid(*channel, rank - ranks, ranks, particles, intervals);
    disconnect(world);
  }
  MPI_Finalize();
  return 0;
}
