// SPDX-License-Identifier: MIT
#include "protocol/wire/session.h"

#include <gtest/gtest.h>

#include <functional>
#include <future>
#include <limits>

#include "protocol/transport/memory_channel.h"
#include "tests/unit/protocol/samples.h"

namespace {

using namespace protocol;

constexpr double kTimeout = 10.0;

State state(std::int64_t id, double x, double y = 0.03) {
  State s;
  s.id = id;
  s.x = {x, y, 0.0};
  return s;
}
Shape shape(std::int64_t id) {
  return {id, 0.00125, 6.135923e-3, 4.8e-9, 1};
}

/// Sends states with a shape each.
SolidSession::Reply send(SolidSession& solid, std::int64_t interval,
                         const std::vector<State>& states, std::uint32_t flags = kContinue) {
  std::vector<Shape> shapes;
  for (const State& s : states) shapes.push_back(shape(s.id));
  return solid.exchange({interval, 0.0, flags}, states, shapes);
}

/// Runs both programs, a thread a rank, and hands on the first exception of either.
void couple(int fluid_ranks, int solid_ranks,
            const std::function<void(FluidSession&, int rank)>& fluid,
            const std::function<void(SolidSession&, int rank)>& solid,
            const std::function<void(Hello&, int rank)>& change_solid = {}) {
  MemoryLink link = make_memory_link(fluid_ranks, solid_ranks);
  const auto guarded = [](Channel& channel, auto&& body) {
    try {
      body();
    } catch (const PeerFault&) {
      throw;
    } catch (const std::exception& e) {
      channel.raise({kFault, e.what()});
      throw;
    }
  };
  std::vector<std::future<void>> parts;
  for (int r = 0; r < fluid_ranks; ++r)
    parts.push_back(std::async(std::launch::async, [&, r] {
      guarded(*link.fluid[r], [&] {
        Hello hello = test::sample_hello(Role::Fluid);  // slabs along y
        hello.subdomain_lo[1] = 0.06 * r / fluid_ranks;
        hello.subdomain_hi[1] = 0.06 * (r + 1) / fluid_ranks;
        FluidSession session(*link.fluid[r], hello, kTimeout);
        session.agree();
        fluid(session, r);
      });
    }));
  for (int r = 0; r < solid_ranks; ++r)
    parts.push_back(std::async(std::launch::async, [&, r] {
      guarded(*link.solid[r], [&] {
        SolidSession session(*link.solid[r], kTimeout);
        Hello hello = test::sample_hello(Role::Solid);
        if (change_solid) change_solid(hello, r);
        session.agree(hello);
        solid(session, r);
      });
    }));
  std::exception_ptr first;
  for (auto& p : parts) try {
      p.get();
    } catch (const PeerFault&) {
      if (!first) first = std::current_exception();
    } catch (...) {
      first = std::current_exception();
    }
  if (first) std::rethrow_exception(first);
}

/// A load that tells which particle it is for.
std::vector<Load> loads_for(const Arrival& arrival, double factor = 1.0) {
  std::vector<Load> loads;
  for (const Particle& p : arrival.particles) {
    const double id = static_cast<double>(p.state.id);
    loads.push_back({p.state.id, {factor * id, 0.0, 0.0}, {0.0, 0.0, 2.0 * factor * id}});
  }
  return loads;
}

/// Answers until the last state. @return ids of every arrival
std::vector<std::vector<std::int64_t>> serve(FluidSession& fluid, double factor = 1.0) {
  std::vector<std::vector<std::int64_t>> ids;
  for (;;) {
    const Arrival& arrival = fluid.receive();
    if (arrival.goodbye) return ids;
    ids.emplace_back();
    for (const Particle& p : arrival.particles) ids.back().push_back(p.state.id);
    if (arrival.head.flags & kLast) return ids;
    fluid.answer(loads_for(arrival, factor));
  }
}

TEST(Session, LateInsertionIntoAnEmptyBoxRemovalAndReturn) {
  std::vector<std::vector<std::int64_t>> ids;
  couple(
      1, 1, [&](FluidSession& f, int) { ids = serve(f); },
      [](SolidSession& s, int) {
        EXPECT_TRUE(send(s, 0, {}).loads.empty());
        const auto inserted = send(s, 1, {state(7, 0.01)});
        ASSERT_EQ(inserted.loads.size(), 1U);
        EXPECT_EQ(inserted.loads[0].force[0], 7.0);
        send(s, 2, {state(3, 0.005), state(7, 0.01)});
        EXPECT_EQ(send(s, 3, {state(3, 0.005)}).loads[0].torque[2], 6.0);  // 7 removed
        send(s, 4, {});
        send(s, 5, {state(7, 0.01)});  // and back
        send(s, 6, {state(7, 0.01)}, kLast);
      });
  const std::vector<std::vector<std::int64_t>> expected{{}, {7}, {3, 7}, {3}, {}, {7}, {7}};
  EXPECT_EQ(ids, expected);
}

TEST(Session, OrderedByIdWhateverTheRanksSend) {
  std::vector<std::vector<std::int64_t>> ids;
  couple(
      1, 3, [&](FluidSession& f, int) { ids = serve(f); },
      [](SolidSession& s, int r) {
        const auto at = [](std::int64_t slot) { return 0.004 * static_cast<double>(slot + 1); };
        for (std::int64_t k = 0; k < 3; ++k) {  // particles migrate: id = (rank + k) mod 3 …
          const std::int64_t slot = (r + k) % 3;
          const auto reply = send(s, k, {state(10 + slot, at(slot)), state(2 - r, at(r), 0.05)});
          EXPECT_EQ(reply.loads[0].force[0], static_cast<double>(10 + (r + k) % 3));
          EXPECT_EQ(reply.loads[1].force[0], static_cast<double>(2 - r));
        }
        send(s, 3, {state(20 - r, at(r))}, kLast);
      });
  EXPECT_EQ(ids[0], (std::vector<std::int64_t>{0, 1, 2, 10, 11, 12}));
  EXPECT_EQ(ids[1], ids[0]);
  EXPECT_EQ(ids[3], (std::vector<std::int64_t>{18, 19, 20}));
}

TEST(Session, ShapesTravelOnlyWhenNewOrChanged) {
  MemoryLink link = make_memory_link(1, 1);
  auto solid = std::async(std::launch::async, [&] {
    SolidSession s(*link.solid[0], kTimeout);
    s.agree(test::sample_hello(Role::Solid));
    const std::vector<State> states{state(1, 0.01), state(2, 0.012)};
    std::vector<Shape> shapes{shape(1), shape(2)};
    for (std::int64_t k = 0; k < 3; ++k) {
      if (k == 2) shapes[1].radius *= 2.0;
      s.exchange({k, 0.0, kContinue}, states, shapes);
    }
  });
  Channel& c = *link.fluid[0];
  c.send(0, encode(test::sample_hello(Role::Fluid)), {kTimeout, ""});
  c.receive(0, {kTimeout, "hello"});
  c.receive(0, {kTimeout, "answer"});
  c.send(0, encode(Answer{}), {kTimeout, ""});
  const std::size_t expected[] = {2, 0, 1};
  for (std::int64_t k = 0; k < 3; ++k) {
    const auto batch = decode<StateBatch>(c.receive(0, {kTimeout, "states"}));
    EXPECT_EQ(batch.shapes.size(), expected[k]) << "interval " << k;
    EXPECT_EQ(batch.states.size(), 2U);
    c.send(0, encode(LoadBatch{batch.head, {{1, {}, {}}, {2, {}, {}}}}), {kTimeout, ""});
  }
  solid.get();
}

TEST(Session, LoadsOfSeveralFluidRanksAddUpOnTheOwner) {
  std::vector<std::vector<std::int64_t>> ids[2];
  couple(
      2, 2, [&](FluidSession& f, int r) { ids[r] = serve(f, r == 0 ? 1.0 : 100.0); },
      [](SolidSession& s, int r) {
        if (r == 0) {  // one well inside each slab, one across their border at y = 0.03
          const auto reply =
              send(s, 0, {state(1, 0.01, 0.01), state(2, 0.01, 0.05), state(3, 0.01, 0.03)});
          EXPECT_EQ(reply.loads[0].force[0], 1.0);
          EXPECT_EQ(reply.loads[1].force[0], 200.0);
          EXPECT_EQ(reply.loads[2].force[0], 303.0);
          EXPECT_EQ(reply.loads[2].torque[2], 606.0);
        } else {  // outside of a box that is not periodic: no fluid, no load
          EXPECT_EQ(send(s, 0, {state(4, 0.03, 0.08)}).loads[0].force[0], 0.0);
        }
        send(s, 1, {}, kLast);
      });
  EXPECT_EQ(ids[0][0], (std::vector<std::int64_t>{1, 3}));
  EXPECT_EQ(ids[1][0], (std::vector<std::int64_t>{2, 3}));
}

TEST(Session, StopIsSeenByEveryRank) {
  couple(
      1, 2,
      [](FluidSession& f, int) {
        f.receive();
        f.answer(loads_for(Arrival{}), kStop);
        EXPECT_TRUE(f.receive().head.flags & kLast);
      },
      [](SolidSession& s, int) {
        EXPECT_TRUE(send(s, 0, {}).flags & kStop);
        send(s, 1, {}, kLast);
      });
}

TEST(Session, GoodbyeCarriesItsReason) {
  std::string reason;
  couple(
      1, 2,
      [&](FluidSession& f, int) {
        f.answer(loads_for(f.receive()));
        reason = f.receive().goodbye.value_or("none");
      },
      [](SolidSession& s, int) {
        send(s, 0, {});
        s.goodbye("script ended");
      });
  EXPECT_EQ(reason, "script ended");
}

TEST(Session, RefusalGivesBothSidesEveryReason) {
  MemoryLink link = make_memory_link(1, 1);
  const auto reasons_of = [](auto&& body) -> std::vector<std::string> {
    try {
      body();
    } catch (const Refusal& r) {
      EXPECT_EQ(r.exit_code(), kBadInput);
      return r.reasons();
    }
    return {};
  };
  auto solid = std::async(std::launch::async, [&] {
    return reasons_of([&] {
      SolidSession s(*link.solid[0], kTimeout);
      Hello hello = test::sample_hello(Role::Solid);
      hello.depth = 0.5;
      hello.gravity[1] = -9.0;
      s.agree(hello);
    });
  });
  const auto fluid = reasons_of(
      [&] { FluidSession(*link.fluid[0], test::sample_hello(Role::Fluid), kTimeout).agree(); });
  EXPECT_EQ(fluid.size(), 2U);
  EXPECT_EQ(solid.get(), fluid);
}

void expect_failure(const std::function<void(SolidSession&, int)>& solid, const std::string& words,
                    int exit_code) {
  try {
    couple(
        1, 1, [](FluidSession& f, int) { serve(f); }, solid);
    FAIL() << "nothing was said about: " << words;
  } catch (const ProtocolError& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
    if (!dynamic_cast<const PeerFault*>(&e)) {
      EXPECT_EQ(e.exit_code(), exit_code);
    }
  }
}

TEST(Session, NamesTheStateThatIsNotFinite) {
  expect_failure(
      [](SolidSession& s, int) {
        State bad = state(5, 0.01);
        bad.v[1] = std::numeric_limits<double>::quiet_NaN();
        send(s, 0, {bad});
      },
      "particle 5: velocity", kNumerics);
}
TEST(Session, NamesAParticleThatComesTwice) {
  expect_failure(
      [](SolidSession& s, int) {
        send(s, 0, {state(5, 0.01), state(5, 0.02)});
      },
      "particle 5 came twice", kFault);
}
TEST(Session, NamesAWrongInterval) {
  expect_failure([](SolidSession& s, int) { send(s, 3, {}); }, "sent interval 3 where 0", kFault);
}
TEST(Session, NamesAShapeThatCannotBe) {
  expect_failure(
      [](SolidSession& s, int) {
        s.exchange({0, 0.0, kContinue}, std::vector{state(5, 0.01)},
                   std::vector<Shape>{{5, 0.00125, -1.0, 1.0, 1}});
      },
      "particle 5: radius", kBadInput);
}

TEST(Session, NamesACountBelowZero) {
  expect_failure(
      [](SolidSession& s, int) {
        s.exchange({0, 0.0, kContinue}, {}, {}, SolidReport{0, BondCounts{1, -3, 0, 0, 0}, {}});
      },
      "counts -3 bonds broken by tension at interval 0", kBadInput);
}

TEST(Session, LoadsThatAreNotFiniteNeverReachTheSolid) {
  EXPECT_THROW(couple(
                   1, 1,
                   [](FluidSession& f, int) {
                     auto loads = loads_for(f.receive());
                     loads[0].force[1] = std::numeric_limits<double>::infinity();
                     f.answer(loads);
                   },
                   [](SolidSession& s, int) { send(s, 0, {state(1, 0.01)}); }),
               ProtocolError);
}

/// What a fluid is told that answers two particles with such loads.
std::string said_of(const std::vector<Load>& loads) {
  std::string said;
  EXPECT_THROW(couple(
                   1, 1,
                   [&](FluidSession& f, int) {
                     f.receive();
                     try {
                       f.answer(loads);
                     } catch (const ProtocolError& error) {
                       said = error.what();
                       throw;
                     }
                   },
                   [](SolidSession& s, int) {
                     send(s, 0, {state(1, 0.01), state(2, 0.015)});
                   }),
               ProtocolError);
  return said;
}

TEST(Session, AnAnswerMustFitTheParticles) {
  EXPECT_EQ(said_of({{1, {}, {}}}), "the fluid computed 1 loads for 2 particles at interval 0");
  EXPECT_EQ(said_of({{1, {}, {}}, {2, {}, {}}, {3, {}, {}}}),
            "the fluid computed 3 loads for 2 particles at interval 0");
  EXPECT_EQ(said_of({{2, {}, {}}, {1, {}, {}}}),
            "the fluid computed a load of particle 2 in place of particle 1 at interval 0");
}

TEST(Session, ASilentPartnerIsNamedWithTheIntervalWaitedFor) {
  MemoryLink link = make_memory_link(1, 1);
  auto solid = std::async(std::launch::async, [&] {
    SolidSession s(*link.solid[0], kTimeout);
    s.agree(test::sample_hello(Role::Solid));
  });
  FluidSession fluid(*link.fluid[0], test::sample_hello(Role::Fluid), 0.3);
  fluid.agree();
  solid.get();
  try {
    fluid.receive();
    FAIL();
  } catch (const Timeout& e) {
    EXPECT_NE(std::string(e.what()).find("states of interval 0"), std::string::npos) << e.what();
  }
}

TEST(TimeOut, OfTheSolidIsThatOfTheFluidsScene) {
  MemoryLink link = make_memory_link(1, 1);
  Hello hello = test::sample_hello(Role::Fluid);
  const auto offered = [&](const char* text) {
    hello.variables = {{"coupling_timeout", text}};
    const FluidSession fluid(*link.fluid[0], hello, kTimeout);
    return SolidSession(*link.solid[0], kTimeout).timeout();
  };
  EXPECT_EQ(offered("7.5"), 7.5);
  EXPECT_EQ(offered("soon"), kTimeout);  // an engine goes on with its own
  EXPECT_EQ(offered("-1"), kTimeout);
}

}  // namespace
