// SPDX-License-Identifier: MIT
/// A program that plays one side of a coupled job by a script that a test needs, and writes what it
/// receives to peer.txt (the terminal mixes the lines of two programs):
///
///   fluid impulse N    load of interval k is (k+1) times a constant; N intervals
///   fluid nan          answers a load that is not finite
///   fluid fewer        answers fewer loads than there are particles
///   fluid silent       says hello and nothing more
///   fluid leave        leaves before its hello
///   solid insert       an empty box, late insertion, removal, return, then the end
///   solid nan          a state that is not finite
///   solid silent       agrees and sends nothing
///   solid slow         answers late, but answers; its handshake counts 3 particles, and it has one
///   solid die          agrees, sends one state and is killed
///   solid leave STAGE HOW   leaves at a stage (connected, hello, agreed, states, running, last,
///                      goodbye, refused, version) by MPI_Finalize only (finalize), by exit, or
///                      with its farewell
///   solid heap         100 000 particles at one place
///   solid step, box    another time step, another box from interval 3 on
///   solid outside, jump, grow, dense, clump   a particle that cannot be, at interval 3
///   solid shapeless, twice             a particle without radius, or two of one id
///   solid swapped, noise, cut, longer  frames of another byte order, of another program, damaged
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "protocol/program/program.h"
#include "protocol/transport/mpi_channel.h"
#include "protocol/wire/session.h"

namespace {

using namespace protocol;

constexpr double kTimeout = 30.0;
std::FILE* received = nullptr;

/// A 2D box of 1 × 1 m for tests of the fix: ten solid steps of 1 ms an interval.
Hello box_hello() {
  Hello h;
  h.program = "scripted_peer";
  h.program_version = "test";
  h.box_lo = {0.0, 0.0, -0.5};
  h.box_hi = {1.0, 1.0, 0.5};
  h.periodic = {1, 1, 1};
  h.step = 1e-2;
  h.solid_steps = 10;
  h.buoyancy = Buoyancy::None;
  h.subdomain_lo = h.box_lo;
  h.subdomain_hi = h.box_hi;
  return h;
}

void fluid(Channel& channel, const std::string& script, int intervals) {
  if (script == "leave") return;
  FluidSession session(channel, box_hello(), kTimeout);
  if (script == "silent") pause();
  session.agree();
  for (int k = 0;; ++k) {
    const Arrival& arrival = session.receive();
    if (arrival.goodbye) {
      fmt::print(received, "goodbye: {}\n", *arrival.goodbye);
      return;
    }
    for (const Particle& p : arrival.particles)
      fmt::print(received, "state {} {} {:.17g} {:.17g} {:.17g} {:.17g} {}\n", k, p.state.id,
                 p.state.x[0], p.state.v[0], p.state.v[1], p.state.omega[2], p.shape.epoch);
    if (arrival.head.flags & kLast) return;
    std::vector<Load> loads;
    for (const Particle& p : arrival.particles)
      loads.push_back(
          {p.state.id, {0.25 * (k + 1), -0.5 * (k + 1), 0.0}, {0.0, 0.0, 0.125 * (k + 1)}});
    if (script == "nan") {
      // past the session's own check, as a foreign program without one would send it
      loads[0].force[0] = std::numeric_limits<double>::quiet_NaN();
      channel.send(0, encode(LoadBatch{arrival.head, loads}), {kTimeout, ""});
      pause();
    }
    if (script == "fewer") {
      channel.send(0, encode(LoadBatch{arrival.head, {}}), {kTimeout, ""});
      pause();
    }
    session.answer(loads, k + 1 == intervals ? kStop : kContinue);
  }
}

State at(std::int64_t id, double x, double y) {
  State s;
  s.id = id;
  s.x = {x, y, 0.0};
  return s;
}

/// A frame as only a broken partner sends it.
Bytes damaged(const std::string& script, const Setting& setting) {
  StateBatch batch{{0, 0.0, kContinue}, setting, {at(4, 0.01, 0.04)}, {}, {}};
  if (script == "twice") {
    batch.states.push_back(batch.states[0]);
    const double mass = 1250.0 * 3.14159265358979 * 0.00125 * 0.00125;
    batch.shapes.push_back({4, 0.00125, mass, 0.5 * mass * 0.00125 * 0.00125, 1});
  }
  Bytes frame = encode(batch);  // shapeless as it is
  if (script == "swapped") std::reverse(frame.begin(), frame.begin() + 4);
  if (script == "noise") frame.assign(64, std::byte{42});
  if (script == "cut") frame.resize(frame.size() / 2);
  if (script == "longer") frame.resize(frame.size() + 8);
  return frame;
}

/// What a broken engine may make of what it sends.
void spoil(const std::string& script, Setting now, SolidSession& session, State& state,
           Shape& shape) {
  if (script == "step") now.step *= 2.0;
  if (script == "box") now.box_hi[1] *= 0.9;
  session.set(now);
  if (script == "outside") state.x[0] = 5.0;
  if (script == "jump") state.x[1] -= 0.025;
  if (script == "grow") shape.radius *= 2.0;
  if (script == "dense") shape.mass *= 2.0;
  if (script == "clump") shape.carrier = 1;
}

/// The hello of a solid for whatever scene the fluid has read: it repeats the fluid's own numbers.
Hello answer_to(Hello hello, std::int64_t particles = 0) {
  hello.role = Role::Solid;
  hello.program = "scripted_peer";
  hello.step = hello.step * hello.fluid_steps / hello.solid_steps;
  hello.particles = particles;
  hello.radius.reset();
  hello.density.reset();
  return hello;
}

Shape disc(std::int64_t id) {
  const double r = 0.00125, mass = 1250.0 * std::numbers::pi * r * r;
  return {id, r, mass, 0.5 * mass * r * r, 1};
}

/// Plays the solid.
void solid(Channel& channel, const std::string& script) {
  SolidSession session(channel, kTimeout);
  const Hello hello = answer_to(session.fluid(), script == "slow" ? 3 : script != "insert");
  const Setting agreed{hello.step, hello.box_lo, hello.box_hi};
  session.agree(hello);
  if (script == "silent") pause();
  for (const char* name : {"shapeless", "twice", "swapped", "noise", "cut", "longer"})
    if (script == name) {
      channel.send(0, damaged(script, agreed), {kTimeout, ""});
      channel.receive(0, {kTimeout, "its complaint"});
    }
  bool stop = false;
  for (std::int64_t k = 0;; ++k) {
    std::vector<State> states;
    if (script != "insert" || k >= 5) states.push_back(at(4, 0.01, 0.04));
    if (script == "insert" && k >= 8 && k < 20) states.push_back(at(2, 0.005, 0.02));
    if (script == "slow" && k % 20 == 3) usleep(300'000);
    if (script == "nan" && k == 3) states[0].v[1] = std::numeric_limits<double>::quiet_NaN();
    if (script == "heap") states.resize(100000, at(4, 0.01, 0.04));
    for (std::size_t i = 0; i < states.size(); ++i)
      if (script == "heap") states[i].id = static_cast<std::int64_t>(i);
    std::vector<Shape> shapes;
    for (const State& s : states) shapes.push_back(disc(s.id));
    if (k == 3 && !states.empty()) spoil(script, agreed, session, states[0], shapes[0]);
    const auto reply = session.exchange({k, 0.0, stop ? kLast : kContinue}, states, shapes);
    if (stop) return;
    for (const Load& l : reply.loads)
      fmt::print(received, "load {} {} {:.9g}\n", k, l.id, l.force[1]);
    if (script == "die") kill(getpid(), SIGKILL);
    stop = reply.flags & kStop;
  }
}

/// The peer has come to a stage at which it is to leave.
struct Here {};

/// Plays the solid up to a stage, and no further.
void play_to(Channel& channel, const std::string& stage) {
  if (stage == "connected") throw Here();
  SolidSession session(channel, kTimeout);
  Hello hello = answer_to(session.fluid());
  if (stage == "refused") hello.gravity[1] *= 2.0;
  if (stage == "version") hello.version = 3;
  if (stage == "hello" || stage == "version") {
    for (int r = 0; r < channel.remote_size(); ++r)
      channel.send(r, encode(hello), {kTimeout, "it to take our handshake"});
    throw Here();
  }
  try {
    session.agree(hello);
  } catch (const Refusal&) {
    throw Here();
  }
  if (stage == "agreed") throw Here();
  const std::vector<State> states{at(4, 0.01, 0.04)};
  const std::vector<Shape> shapes{disc(4)};
  std::uint32_t flags = kContinue;
  for (std::int64_t k = 0;; ++k) {
    if (k == 3 && stage == "goodbye") session.goodbye("has seen enough");
    if (k == 3 && (stage == "goodbye" || stage == "running")) throw Here();
    session.send({k, 0.0, flags}, states, shapes);
    if (stage == "states" || flags == kLast) throw Here();
    if (session.collect().flags & kStop) flags = kLast;
  }
}

/// @return only where it is to leave with its farewell
void leave(Channel& channel, const std::string& stage, const std::string& how) {
  try {
    play_to(channel, stage);
  } catch (const Here&) {
  }
  if (how == "exit") std::_Exit(0);
  if (how != "finalize") return;
  PMPI_Finalize();
  std::_Exit(0);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string side = argc > 1 ? argv[1] : "", script = argc > 2 ? argv[2] : "";
  MPI_Init(&argc, &argv);
  catch_signals();
  if (script == "leave") setenv("BPLBM_WATCH", "0", 1);  // as a program that is not ours
  const Role role = side == "fluid" ? Role::Fluid : Role::Solid;
  received = std::fopen("peer.txt", "w");
  std::setvbuf(received, nullptr, _IOLBF, 0);
  std::unique_ptr<Channel> channel;
  World world;
  int code = 0;
  try {
    world = connect(role);
    channel = make_mpi_channel(world, role);
    if (role == Role::Fluid)
      fluid(*channel, script, argc > 3 ? std::atoi(argv[3]) : 3);
    else
      script == "leave" ? leave(*channel, argv[3], argv[4]) : solid(*channel, script);
  } catch (const std::exception& e) {
    code = leave_after(e, "scripted_peer", channel.get());
  }
  return finish(code, "scripted_peer", channel, world.local);
}
