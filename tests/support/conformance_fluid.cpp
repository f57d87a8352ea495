// SPDX-License-Identifier: MIT
/// `conformance_fluid CHECK`: a fluid without a fluid, which looks whether a solid program keeps to
/// the protocol. Writes "ok" or what was wrong to conformance.txt; exit code 0 or 1.
///
/// The box is 1 × 1 m, the interval ten solid steps of 1 ms. What particles there are is offered as
/// particle1_x, _y, _vx, _vy and _interval (of its insertion).
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "protocol/program/program.h"
#include "protocol/transport/mpi_channel.h"
#include "protocol/wire/session.h"

namespace {

using namespace protocol;

constexpr double kTimeout = 20.0, kInterval = 1e-2, kRadius = 0.05, kDensity = 1000.0;
const double kMass = kDensity * std::numbers::pi * kRadius * kRadius;

struct Wrong : std::runtime_error {
  using std::runtime_error::runtime_error;
};
void expect(bool good, const std::string& what) {
  if (!good) throw Wrong(what);
}
void expect_near(double value, double exact, double tolerance, const std::string& what) {
  expect(std::abs(value - exact) <= tolerance,
         fmt::format("{}: {:.17g} instead of {:.17g}", what, value, exact));
}

struct Start {
  double x, y, vx = 0.0, vy = 0.0;
  int interval = 0;
};

Hello box_hello(bool periodic, const std::vector<Start>& particles) {
  Hello h;
  h.program = "conformance_fluid";
  h.program_version = "test";
  h.box_lo = {0.0, 0.0, -0.5};
  h.box_hi = {1.0, 1.0, 0.5};
  h.periodic = {periodic, periodic, 1};
  h.step = kInterval;
  h.solid_steps = 10;
  h.radius = Range{kRadius, kRadius};
  h.density = Range{kDensity, kDensity};
  h.subdomain_lo = h.box_lo;
  h.subdomain_hi = h.box_hi;
  const auto offer = [&h](const std::string& name, double value) {
    h.variables.push_back({name, fmt::format("{}", value)});
  };
  const char* axis[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    offer(fmt::format("{}_lo", axis[k]), h.box_lo[k]);
    offer(fmt::format("{}_hi", axis[k]), h.box_hi[k]);
    h.variables.push_back({fmt::format("boundary_{}", axis[k]), h.periodic[k] ? "p" : "f"});
    offer(fmt::format("walls_{}", axis[k]), 0);  // the sides are open
  }
  for (const auto& [name, value] : {std::pair{"depth", 1.0},
                                    {"gravity", 0.0},
                                    {"gravity_x", 0.0},
                                    {"gravity_y", -1.0},
                                    {"solid_step", kInterval / 10},
                                    {"substeps", 10.0},
                                    {"solid_steps_total", 100000.0},
                                    {"diameter_min", 2 * kRadius},
                                    {"diameter_max", 2 * kRadius},
                                    {"density_min", kDensity},
                                    {"density_max", kDensity},
                                    {"contact_stiffness", 1e5},
                                    {"damping_ratio", 0.1},
                                    {"restart", 0.0},
                                    {"particles", static_cast<double>(particles.size())}})
    offer(name, value);
  h.variables.push_back({"checkpoint", "checkpoint"});
  h.variables.push_back({"restart_file", "none"});
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const std::string p = fmt::format("particle{}_", i + 1);
    offer(p + "x", particles[i].x);
    offer(p + "y", particles[i].y);
    offer(p + "vx", particles[i].vx);
    offer(p + "vy", particles[i].vy);
    offer(p + "interval", particles[i].interval);
  }
  return h;
}

/// Intervals with loads of the caller's choice; `look` sees the particles of each.
template <class Loads, class Look>
void converse(Channel& channel, const Hello& hello, int intervals, Loads&& load, Look&& look,
              std::uint32_t flag_at_two = kContinue) {
  FluidSession session(channel, hello, kTimeout);
  const Hello& solid = session.agree();
  expect(solid.role == Role::Solid, "the hello does not say that it is a solid");
  for (int k = 0;; ++k) {
    const Arrival& arrival = session.receive();
    expect(!arrival.goodbye, "it left: " + arrival.goodbye.value_or(""));
    const bool last = k == intervals;
    expect(((arrival.head.flags & kLast) != 0) == last,
           fmt::format("interval {}: it says {} the last", k, last ? "not" : "too early"));
    expect(((arrival.head.flags & kCheckpoint) != 0) == (k == 3 && flag_at_two == kCheckpoint),
           fmt::format("interval {}: checkpoint not written when asked, or unasked", k));
    look(k, arrival);
    if (last) return;
    std::vector<Load> loads;
    for (const Particle& p : arrival.particles) loads.push_back(load(k, p));
    session.answer(loads, (k + 1 == intervals ? kStop : kContinue) | (k == 2 ? flag_at_two : 0U));
  }
}

Load nothing(int, const Particle& p) {
  return {p.state.id, {}, {}};
}
Load pushed(int k, const Particle& p) {
  return {p.state.id, {0.25 * (k + 1), -0.5 * (k + 1), 0.0}, {0.0, 0.0, 0.01 * (k + 1)}};
}

void move(Channel& channel) {
  std::vector<Particle> before;
  const double inertia = 0.5 * kMass * kRadius * kRadius;
  converse(channel, box_hello(false, {{0.3, 0.5}, {0.7, 0.5}}), 20, pushed,
           [&](int k, const Arrival& now) {
             expect(now.particles.size() == 2, "there are not two particles");
             for (std::size_t i = 0; i < 2; ++i) {
               const auto& [s, shape] = now.particles[i];
               expect_near(shape.mass, kMass, 1e-9 * kMass, "mass");
               expect_near(shape.inertia, inertia, 1e-9 * inertia, "inertia of a disc");
               if (k == 0) continue;
               const State& b = before[i].state;
               const Load load = pushed(k - 1, before[i]);
               for (int a = 0; a < 2; ++a) {
                 expect_near(kMass * (s.v[a] - b.v[a]), load.force[a] * kInterval, 1e-12,
                             "impulse of an interval");
                 expect_near(s.x[a] - b.x[a], 0.5 * (s.v[a] + b.v[a]) * kInterval, 1e-12,
                             "way of an interval");
               }
               expect_near(inertia * (s.omega[2] - b.omega[2]), load.torque[2] * kInterval, 1e-12,
                           "angular impulse of an interval");
             }
             before = now.particles;
           });
}

void collide(Channel& channel) {
  converse(channel, box_hello(false, {{0.4, 0.5, 1.0, 0.0}, {0.6, 0.51, -0.5, 0.0}}), 30, nothing,
           [](int k, const Arrival& now) {
             double momentum = 0.0;
             for (const auto& p : now.particles) momentum += kMass * p.state.v[0];
             expect_near(momentum, 0.5 * kMass, 1e-9 * kMass, "momentum of the two");
             if (k == 30)
               expect(now.particles[0].state.v[0] < now.particles[1].state.v[0],
                      "they do not part");
           });
}

void corner(Channel& channel) {
  converse(channel, box_hello(true, {{0.97, 0.96, 2.0, 3.0}}), 20, nothing,
           [](int k, const Arrival& now) {
             const double speed[] = {2.0, 3.0}, start[] = {0.97, 0.96};
             expect(now.particles.size() == 1, "there is not one particle");
             for (int a = 0; a < 2; ++a) {
               const double x = now.particles[0].state.x[a],
                            way = start[a] + speed[a] * kInterval * k;
               expect(x >= -2 * kRadius && x <= 1.0 + 2 * kRadius, "it is far outside of the box");
               expect_near(std::remainder(x - way, 1.0), 0.0, 1e-9, "place modulo the box");
             }
           });
}

void vanish(Channel& channel) {
  converse(channel, box_hello(false, {{0.9, 0.5, 2.0, 0.0}, {0.3, 0.5}}), 40, nothing,
           [](int k, const Arrival& now) {
             if (k == 0) expect(now.particles.size() == 2, "there are not two particles");
             if (k == 40) {
               expect(now.particles.size() == 1, "the one that left is still there");
               expect_near(now.particles[0].state.x[0], 0.3, 1e-12, "place of the other");
             }
           });
}

void late(Channel& channel) {
  double speed = 0.0;
  converse(channel, box_hello(false, {{0.3, 0.5, 0.0, 0.0, 5}}), 10, pushed,
           [&speed](int k, const Arrival& now) {
             expect(now.particles.size() == (k < 5 ? 0U : 1U),
                    fmt::format("interval {}: {} particles", k, now.particles.size()));
             if (k < 5) return;
             expect_near(now.particles[0].shape.mass, kMass, 1e-9 * kMass, "mass");
             if (k == 5) expect_near(now.particles[0].state.x[0], 0.3, 1e-12, "place");
             expect_near(now.particles[0].state.v[0], speed, 1e-12, "speed");
             speed += pushed(k, now.particles[0]).force[0] * kInterval / kMass;
           });
}

void nan_load(Channel& channel) {
  FluidSession session(channel, box_hello(false, {{0.3, 0.5}}), kTimeout);
  session.agree();
  const Arrival& arrival = session.receive();
  Load load{arrival.particles[0].state.id, {}, {}};
  load.force[0] = std::numeric_limits<double>::quiet_NaN();
  // past the session's own check, as a foreign fluid without one would send it
  channel.send(0, encode(LoadBatch{arrival.head, {load}}), {kTimeout, ""});
  try {
    session.receive();
  } catch (const PeerFault& fault) {
    expect(std::string(fault.what()).find("not finite") != std::string::npos,
           fmt::format("its reason does not say 'not finite': {}", fault.what()));
    throw;
  }
  throw Wrong("it went on with a load that is not finite");
}

void refused(Channel& channel, Hello hello, const std::string& word) {
  try {
    FluidSession session(channel, std::move(hello), kTimeout);
    session.agree();
  } catch (const ProtocolError& e) {
    expect(std::string(e.what()).find(word) != std::string::npos,
           fmt::format("no '{}' in: {}", word, e.what()));
    throw;
  }
  throw Wrong("it was not refused");
}

void check(const std::string& name, Channel& channel) {
  const std::vector<Start> one{{0.3, 0.5}};
  Hello hello = box_hello(false, one);
  if (name == "move") move(channel);
  if (name == "collide") collide(channel);
  if (name == "corner") corner(channel);
  if (name == "vanish") vanish(channel);
  if (name == "late") late(channel);
  if (name == "stop") converse(channel, hello, 1, nothing, [](int, const Arrival&) {});
  if (name == "checkpoint") {
    hello.features = kCheckpoints;
    converse(
        channel, hello, 6, nothing, [](int, const Arrival&) {}, kCheckpoint);
  }
  if (name == "fail") nan_load(channel);
  if (name == "version") {
    hello.version = 99;
    refused(channel, hello, "version");
  }
  if (name == "box") {
    hello.box_hi[0] = 1.1;  // the variables say 1
    hello.subdomain_hi = hello.box_hi;
    refused(channel, hello, "box x");
  }
}

void say(const std::string& text) {
  std::FILE* file = std::fopen("conformance.txt", "w");
  fmt::print(file, "{}\n", text);
  std::fclose(file);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string name = argc > 1 ? argv[1] : "";
  MPI_Init(&argc, &argv);
  catch_signals();
  std::unique_ptr<Channel> channel;
  World world;
  int code = 0;
  try {
    world = connect(Role::Fluid);
    channel = make_mpi_channel(world, Role::Fluid);
    check(name, *channel);
    say("ok");
  } catch (const Wrong& e) {
    say(e.what());
    code = leave_after(ProtocolError(e.what()), "conformance_fluid", channel.get());
  } catch (const std::exception& e) {
    say(name == "fail" || name == "version" || name == "box" ? "ok" : e.what());
    code = leave_after(e, "conformance_fluid", channel.get());
  }
  return finish(code, "conformance_fluid", channel, world.local);
}
