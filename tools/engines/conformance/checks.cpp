// SPDX-License-Identifier: MIT
#include "tools/engines/conformance/checks.h"

#include <fmt/format.h>
#include <mpi.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <thread>

#include "protocol/program/program.h"
#include "protocol/wire/codec.h"
#include "tools/engines/conformance/clump_check.h"

namespace conformance {

using namespace protocol;

namespace {

using Particles = std::vector<Particle>;
constexpr auto look_away = [](int, const Particles&) {};

void sleep_for(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

void expect_count(const Particles& now, std::size_t count, int interval) {
  expect(now.size() == count,
         fmt::format("interval {}: {} particles instead of {}", interval, now.size(), count));
}

// ---- motion ------------------------------------------------------------------------------------

/// What a load does in an interval.
void expect_step(const Particle& before, const Particle& now, const Load& load,
                 const Scene& scene) {
  for (int a = 0; a < 2; ++a) {
    expect_near(scene.mass() * (now.state.v[a] - before.state.v[a]), load.force[a] * kInterval,
                1e-12, "impulse of an interval");
    expect_near(now.state.x[a] - before.state.x[a],
                0.5 * (now.state.v[a] + before.state.v[a]) * kInterval, 1e-12,
                "way of an interval");
  }
  expect_near(scene.inertia() * (now.state.omega[2] - before.state.omega[2]),
              load.torque[2] * kInterval, 1e-12, "angular impulse of an interval");
}

void expect_disc(const Shape& s, const Scene& scene) {
  expect_near(s.radius, kRadius, 1e-9 * kRadius, "radius");
  expect_near(s.mass, scene.mass(), 1e-9 * scene.mass(), "mass (of the agreed depth)");
  expect_near(s.inertia, scene.inertia(), 1e-9 * scene.inertia(), "inertia of a disc");
  expect(s.carrier == kItself || s.carrier == s.id, "a disc is its own carrier");
}

/// Discs under loads that grow; all of them are there all the time.
void follow(Judge& judge, const Scene& scene, int intervals) {
  Particles before;
  judge.converse(judge.hello(scene), intervals, pushed, [&](int k, const Particles& now) {
    expect_count(now, scene.discs.size(), k);
    for (std::size_t i = 0; i < now.size(); ++i) {
      expect_disc(now[i].shape, scene);
      if (k > 0) expect_step(before[i], now[i], pushed(k - 1, before[i]), scene);
    }
    before = now;
  });
}

void move(Judge& judge) {
  follow(judge, {.discs = {{0.3, 0.5}, {0.7, 0.5}}}, 20);
}

void mass(Judge& judge) {
  Scene scene;
  scene.depth = 0.25;
  scene.density = 1500.0;
  follow(judge, scene, 3);
}

void ranks(Judge& judge) {
  follow(judge, {.discs = {{0.3, 0.3, 1.0, 0.5}, {0.7, 0.6, -2.0, 0.1}}}, 15);
}

void collide(Judge& judge) {
  const Scene scene{.discs = {{0.4, 0.5, 1.0, 0.0}, {0.6, 0.51, -0.5, 0.0}}};
  judge.converse(judge.hello(scene), 30, nothing, [&](int k, const Particles& now) {
    expect_count(now, 2, k);
    double momentum = 0.0;
    for (const auto& p : now) momentum += scene.mass() * p.state.v[0];
    expect_near(momentum, 0.5 * scene.mass(), 1e-9 * scene.mass(), "momentum of the two");
    if (k == 30) expect(now[0].state.v[0] < now[1].state.v[0], "they do not part");
  });
}

void corner(Judge& judge) {
  const Scene scene{.discs = {{0.97, 0.96, 2.0, 3.0}}, .periodic = true};
  judge.converse(judge.hello(scene), 20, nothing, [](int k, const Particles& now) {
    const double speed[] = {2.0, 3.0}, start[] = {0.97, 0.96};
    expect_count(now, 1, k);
    for (int a = 0; a < 2; ++a) {
      const double x = now[0].state.x[a], way = start[a] + speed[a] * kInterval * k;
      expect(x >= -2 * kRadius && x <= 1.0 + 2 * kRadius, "it is far outside of the box");
      expect_near(std::remainder(x - way, 1.0), 0.0, 1e-9, "place modulo the box");
    }
  });
}

void vanish(Judge& judge) {
  const Scene scene{.discs = {{0.9, 0.5, 2.0, 0.0}, {0.3, 0.5}}};
  judge.converse(judge.hello(scene), 40, nothing, [](int k, const Particles& now) {
    if (k == 0) expect_count(now, 2, k);
    if (k < 40) return;
    expect(now.size() == 1, "the one that left is still there");
    expect_near(now[0].state.x[0], 0.3, 1e-12, "place of the other");
  });
}

void late(Judge& judge) {
  const Scene scene{.discs = {{.x = 0.3, .y = 0.5, .interval = 5}}};
  Particles before;
  judge.converse(judge.hello(scene), 10, pushed, [&](int k, const Particles& now) {
    expect_count(now, k < 5 ? 0 : 1, k);
    if (k == 5) expect_near(now[0].state.x[0], 0.3, 1e-12, "place");
    if (k == 5) expect_near(now[0].state.v[0], 0.0, 1e-12, "speed");
    if (k >= 5) expect_disc(now[0].shape, scene);
    if (k > 5) expect_step(before[0], now[0], pushed(k - 1, now[0]), scene);
    before = now;
  });
}

/// One disc is taken out, and in the same interval another comes, to which the id may pass.
void epoch(Judge& judge) {
  const Scene scene{
      .discs = {{.x = 0.2, .y = 0.5, .until = 6}, {.x = 0.8, .y = 0.5, .interval = 6, .id = 1}}};
  Particles before;
  judge.converse(judge.hello(scene), 9, nothing, [&](int k, const Particles& now) {
    expect_count(now, 1, k);
    expect_near(now[0].state.x[0], k < 6 ? 0.2 : 0.8, 1e-12, "place");
    const bool same = k > 0 && now[0].shape.id == before[0].shape.id &&
                      now[0].shape.epoch == before[0].shape.epoch;
    expect(k == 0 || same == (k != 6),
           k == 6 ? "the id has passed to another particle with the epoch of the one before"
                  : fmt::format("interval {}: another id or epoch, but the same particle", k));
    before = now;
  });
}

// ---- what is agreed ----------------------------------------------------------------------------

/// @param word  that the refusal must contain
void refused(Judge& judge, const Hello& hello, const std::string& word) {
  try {
    judge.converse(hello, 3, nothing, look_away);
  } catch (const ProtocolError& e) {
    expect(std::string(e.what()).find(word) != std::string::npos,
           fmt::format("no '{}' in: {}", word, e.what()));
    throw;
  }
  throw Wrong("it was not refused");
}

void version(Judge& judge) {
  Hello hello = judge.hello({});
  hello.version = 99;
  refused(judge, hello, "version");
}

void box(Judge& judge) {
  Hello hello = judge.hello({});
  hello.box_hi[0] = 1.1;  // the variables say 1
  hello.subdomain_hi = hello.box_hi;
  refused(judge, hello, "box x");
}

void density(Judge& judge) {
  Hello hello = judge.hello({});
  hello.density = Range{2000.0, 2000.0};  // the variables say 1000
  refused(judge, hello, "density");
}

// ---- flags -------------------------------------------------------------------------------------

void stop(Judge& judge) {
  judge.converse(judge.hello({}), 1, nothing, look_away);
}

void checkpoint(Judge& judge) {
  Hello hello = judge.hello({});
  hello.features = kCheckpoints;
  judge.converse(hello, 6, nothing, look_away, kCheckpoint);
  for (const Variable& v : hello.variables)
    if (v.name == "checkpoint")
      expect(std::filesystem::exists(v.value + ".3.solid"),
             "there is no file checkpoint.3.solid, though its states of interval 3 say so");
}

// ---- patience ----------------------------------------------------------------------------------

void slow_start(Judge& judge) {
  sleep_for(3.0);
  stop(judge);
}

void slow_loads(Judge& judge) {
  judge.before_answer = [](int k) {
    if (k == 1) sleep_for(3.0);
  };
  follow(judge, {}, 3);
}

/// The engine must find out by itself.
void silence(Judge& judge) {
  Scene scene;
  scene.timeout = 2.0;
  judge.converse_until(judge.hello(scene), 2);
  try {
    judge.channel().receive(0, {judge.short_patience(), "its complaint"});
  } catch (const Timeout&) {
    throw Wrong(fmt::format("the scene's coupling_timeout is 2 s, and it still waits after {:g} s",
                            judge.short_patience()));
  }
  throw Wrong("it sent something in place of a complaint");
}

// ---- faults ------------------------------------------------------------------------------------

/// The beginning of a conversation, frame by frame. @return  what the engine refuses
std::vector<std::string> shake_hands(Judge& judge, const Answer& mine) {
  Channel& channel = judge.channel();
  const Bytes hello = encode(judge.part(judge.hello({}))), answer = encode(mine);
  const int solids = channel.remote_size();
  const double patience = judge.patience();
  for (int r = 0; r < solids; ++r) channel.send(r, hello, {patience, "its mail box"});
  for (int r = 0; r < solids; ++r) decode<Hello>(channel.receive(r, {patience, "its handshake"}));
  for (int r = 0; r < solids; ++r) channel.send(r, answer, {patience, "its mail box"});
  std::vector<std::string> reasons;
  for (int r = 0; r < solids; ++r)
    for (const auto& reason : decode<Answer>(channel.receive(r, {patience, "its answer"})).reasons)
      reasons.push_back(reason);
  return reasons;
}

/// By hand, past the session's own check, as a foreign fluid without one would send it.
void fail(Judge& judge) {
  expect_passes([&] { shake_hands(judge, {}); });
  Channel& channel = judge.channel();
  for (int r = 0; r < channel.remote_size(); ++r) {
    const auto states =
        decode<StateBatch>(channel.receive(r, {judge.patience(), "the states of interval 0"}));
    LoadBatch loads{{0, 0.0, kContinue}, {}};
    for (const State& s : states.states) {
      loads.loads.push_back({s.id, {}, {}});
      loads.loads.back().force[0] = std::numeric_limits<double>::quiet_NaN();
    }
    channel.send(r, encode(loads), {judge.short_patience(), "its complaint"});
  }
  try {
    channel.receive(0, {judge.short_patience(), "its complaint"});
  } catch (const PeerFault& fault) {
    expect(std::string(fault.what()).find("not finite") != std::string::npos,
           fmt::format("its reason does not say 'not finite': {}", fault.what()));
    throw;
  }
  throw Wrong("it went on with a load that is not finite");
}

void raise(Judge& judge) {
  judge.channel().raise({kNumerics, "the judge stops here"});
}

void fault(Judge& judge) {
  judge.converse_until(judge.hello({}), 3);
  raise(judge);
  judge.expect_farewell("a fault");
  throw Aborts{kNumerics};
}

// ---- the end -----------------------------------------------------------------------------------

void end(Judge& judge) {
  stop(judge);
  judge.expect_farewell("its last states");
}

void end_late(Judge& judge) {
  end(judge);
  sleep_for(4.0);  // as a fluid that writes its last frame
}

void end_refused(Judge& judge) {
  std::vector<std::string> reasons;
  expect_passes([&] { reasons = shake_hands(judge, {false, {"the judge refuses"}}); });
  expect(reasons.empty(), "it refuses as well" + (reasons.empty() ? "" : ": " + reasons[0]));
  judge.expect_farewell("a refusal");
  throw Refusal({"the judge refuses"});
}

/// In place of the fluid's farewell; the engine must end the job by itself.
void end_fault(Judge& judge) {
  expect_passes([&] { end(judge); });
  raise(judge);
  for (double waited = 0.0; waited < judge.short_patience() && !signalled(); waited += 0.1) {
    sleep_for(0.1);
    int here = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &here, MPI_STATUS_IGNORE);
  }
  expect(signalled(),
         fmt::format("a fault in place of the fluid's farewell: it does not end within {:g} s",
                     judge.short_patience()));
  throw Aborts{kNumerics};
}

void end_left(Judge& judge) {
  judge.converse_until(judge.hello({}), 3);
  judge.channel().say_farewell();
  judge.expect_farewell("the fluid's own, which came in place of loads");
  throw PeerLeft("the judge left in place of loads");
}

const Check kChecks[] = {
    {"move", "moves by load × interval to 1e-12, in place and spin; mass and inertia of discs", 0,
     1, move},
    {"mass", "masses and inertias are those of the agreed depth, here 0.25 m", 0, 1, mass},
    {"collide", "keeps the momentum of two discs to 1e-9, and parts them", 0, 1, collide},
    {"corner", "crosses a periodic corner, and stays in the box", 0, 1, corner},
    {"vanish", "a disc leaves an open box, the other goes on", 0, 1, vanish},
    {"late", "an empty box fills at interval 5", 0, 1, late},
    {"epoch", "one disc out, another in: a new id, or the old one with another epoch", 0, 1, epoch},
    {"ranks", "two fluid ranks: each gets what touches it, the loads of both are added", 0, 2,
     ranks},
    {"clump", "clumps move as one body of the union's mass; for an engine that has them", 0, 1,
     clump, true},
    {"stop", "the states after a stop are flagged as the last", 0, 1, stop},
    {"checkpoint", "writes P.k.solid and says so when asked, not unasked", 0, 1, checkpoint},
    {"version", "another protocol version is refused", 2, 1, version},
    {"box", "another box is refused with both numbers", 2, 1, box},
    {"density", "a density outside the agreed range ends both", 2, 1, density},
    {"slow_start", "waits for a handshake that comes 3 s late", 0, 1, slow_start},
    {"slow_loads", "waits for loads that come 3 s late", 0, 1, slow_loads},
    {"silence", "gives up after the scene's time-out, here 2 s", 1, 1, silence},
    {"fail", "a load that is not finite ends both with the reason", 3, 1, fail},
    {"fault", "says farewell after a fault of the fluid, and leaves with its exit code", 3, 1,
     fault},
    {"end", "says farewell after the last states", 0, 1, end},
    {"end_late", "waits for the fluid's farewell, which comes 4 s late", 0, 1, end_late},
    {"end_refused", "says farewell after a refusal that only the fluid has", 2, 1, end_refused},
    {"end_fault", "a fault in place of the fluid's farewell ends it", 3, 1, end_fault},
    {"end_left", "a farewell in place of loads ends it in good order", 1, 1, end_left},
};

}  // namespace

std::span<const Check> checks() {
  return kChecks;
}

const Check* find(const std::string& name) {
  for (const Check& c : kChecks)
    if (c.name == name) return &c;
  return nullptr;
}

}  // namespace conformance
