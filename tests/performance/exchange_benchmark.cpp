// SPDX-License-Identifier: MIT
/// `mpirun -np 2 exchange_benchmark`: microseconds that an exchange takes, states there and loads
/// back, without any physics, by number of particles.
#include <fmt/format.h>

#include <chrono>
#include <numeric>

#include "protocol/mpi_channel.h"
#include "protocol/session.h"

namespace {

using namespace protocol;

constexpr double kTimeout = 60.0;

Hello hello(Role role) {
  Hello h;
  h.role = role;
  h.box_hi = h.subdomain_hi = {1.0, 1.0, 1.0};
  h.step = 1.0;
  return h;
}

void fluid(Channel& channel, int intervals) {
  FluidSession session(channel, hello(Role::Fluid), kTimeout);
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

void solid(Channel& channel, int particles, int intervals) {
  SolidSession session(channel, kTimeout);
  session.agree(hello(Role::Solid));
  std::vector<State> states(particles);
  std::vector<Shape> shapes(particles);
  for (int i = 0; i < particles; ++i) {
    states[i] = {i, {0.5, 0.5, 0.0}, {}, {}};
    shapes[i] = {i, 0.1, 1.0, 1.0, 1};
  }
  const int warm = intervals / 5;
  auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < intervals; ++k) {
    if (k == warm) start = std::chrono::steady_clock::now();
    session.exchange({k, 0.0, kContinue}, states, shapes);
  }
  const std::chrono::duration<double, std::micro> spent = std::chrono::steady_clock::now() - start;
  session.exchange({intervals, 0.0, kLast}, states, shapes);
  fmt::print("{:>8} particles {:>10.1f} µs an exchange, {:.0f} bytes\n", particles,
             spent.count() / (intervals - warm), particles * double(sizeof(State) + sizeof(Load)));
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int rank = 0, size = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (size != 2) {
    if (rank == 0) fmt::print(stderr, "exchange_benchmark | error | start: mpirun -np 2\n");
    MPI_Finalize();
    return 2;
  }
  const Role role = rank == 0 ? Role::Fluid : Role::Solid;
  for (const auto& [particles, intervals] :
       {std::pair{1, 20000}, {500, 20000}, {10000, 1000}, {100000, 100}}) {
    World world = connect(role);
    const auto channel = make_mpi_channel(world, role);
    if (role == Role::Fluid)
      fluid(*channel, intervals);
    else
      solid(*channel, particles, intervals);
    disconnect(world);
  }
  MPI_Finalize();
  return 0;
}
