// SPDX-License-Identifier: MIT
/// `replay --as solid|fluid trace.h5` stands in for a program with what was recorded, and compares
/// what the other one sends with the recording.
#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "protocol/program/command_line.h"
#include "protocol/program/mpi_start.h"
#include "protocol/program/program.h"
#include "protocol/program/watch.h"
#include "protocol/transport/mpi_channel.h"
#include "protocol/transport/trace_compare.h"
#include "protocol/wire/session.h"

namespace {

using namespace protocol;

struct Options {
  std::string as, path;
  double tolerance = 0.0, timeout = 300.0;
  bool physics = false;  ///< places in radii, loads in weights

  TraceComparison comparison(const Trace& trace, std::span<const IntervalRecord> record) const {
    return TraceComparison(physics ? physical_scales(record, trace.hello(Role::Fluid))
                                   : largest_norms(record));
  }
};

/// Sends the recorded states from rank 0, whatever the number of ranks, and compares the loads.
TraceComparison play_solid(Channel& channel, const Trace& trace, const Options& options) {
  const auto record = timeline(trace);
  TraceComparison result = options.comparison(trace, record);
  SolidSession session(channel, options.timeout);
  session.agree(trace.hello(Role::Solid));
  const bool speaks = channel.local_rank() == 0;
  bool stop = false;
  for (const IntervalRecord& r : record) {
    StepHeader head = r.head;
    if (stop) head.flags |= kLast;
    session.set(r.setting);
    const auto reply =
        speaks ? session.exchange(head, r.states, r.shapes) : session.exchange(head, {}, {});
    if (head.flags & kLast) return result;
    if (speaks) result.loads(head.interval, r.loads, reply.loads);
    stop = reply.flags & kStop;
  }
  session.goodbye("the recording ends here");
  return result;
}

/// The fluid's handshake without the folder of the run that was recorded: a script must not write
/// there again.
Hello hello_to_replay(const Trace& trace) {
  Hello hello = trace.hello(Role::Fluid);
  std::erase_if(hello.variables, [](const Variable& v) { return v.name == "out_folder"; });
  return hello;
}

/// Answers the recorded loads by particle id and compares the states.
TraceComparison play_fluid(Channel& channel, const Trace& trace, const Options& options) {
  const auto record = timeline(trace);
  TraceComparison result = options.comparison(trace, record);
  FluidSession session(channel, hello_to_replay(trace), options.timeout);
  session.agree();
  std::vector<State> states;
  std::vector<Load> loads;
  for (const IntervalRecord& r : record) {
    const Arrival& arrival = session.receive();
    if (arrival.goodbye) return result;
    states.clear();
    for (const Particle& p : arrival.particles) states.push_back(p.state);
    result.states(r.head.interval, r.states, states);
    if (arrival.head.flags & kLast) return result;
    loads.clear();
    for (const State& s : states) {
      const auto found =
          std::find_if(r.loads.begin(), r.loads.end(), [&](const Load& l) { return l.id == s.id; });
      if (found == r.loads.end())
        throw ProgramError(fmt::format("the recording holds no load for particle {} at interval {}",
                                       s.id, r.head.interval));
      loads.push_back(*found);
    }
    session.answer(loads, r.load_flags);
  }
  throw ProgramError("the recording ends here, but the solid goes on");
}

int run(const Options& options, std::unique_ptr<Channel>& channel, World& world) {
  const Role role = options.as == "solid" ? Role::Solid : Role::Fluid;
  world = connect(role);
  limit_waits(options.timeout);
  if (!world.coupled())
    throw ProgramError(
        fmt::format("no partner to replay to; start: mpirun -np 1 {}",
                    role == Role::Solid ? "lbm scene.toml : -np 1 replay --as solid trace.h5"
                                        : "replay --as fluid trace.h5 : -np 1 liggghts -in FILE"),
        kBadInput);
  channel = make_mpi_channel(world, role);
  int ranks = 0;
  MPI_Comm_size(world.local, &ranks);
  if (role == Role::Fluid && ranks > 1)
    throw ProgramError("start 'replay --as fluid' with one rank", kBadInput);
  const Trace trace(options.path);
  const auto result = role == Role::Solid ? play_solid(*channel, trace, options)
                                          : play_fluid(*channel, trace, options);
  if (channel->local_rank() == 0)
    fmt::print("replay | {} | {}\n", role == Role::Solid ? "loads" : "states", result.text());
  return result.largest() <= options.tolerance ? kOk : kFault;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Stands in for one program of a coupled job with a recorded exchange"};
  app.add_option("--as", options.as, "the program to stand in for")
      ->required()
      ->check(CLI::IsMember({"solid", "fluid"}));
  app.add_option("--tolerance", options.tolerance, "largest relative difference that passes")
      ->check(finite_number(0.0, true));
  app.add_flag("--physics", options.physics,
               "measure places in radii, loads in weights; else in the largest of all");
  app.add_option("--timeout", options.timeout, "longest wait for the partner [s]")
      ->check(finite_number(0.0));
  app.add_option("trace", options.path, "file written with --record")->required();
  if (const auto code = read_command_line(app, "replay", argc, argv)) return *code;

  {
    const MpiStart bounded("replay");
    MPI_Init(&argc, &argv);
  }
  std::unique_ptr<Channel> channel;
  World world;
  int code = kOk;
  try {
    code = run(options, channel, world);
  } catch (const std::exception& error) {
    code = leave_after(error, "replay", channel.get());
  }
  return finish(code, "replay", channel, world.local);
}
