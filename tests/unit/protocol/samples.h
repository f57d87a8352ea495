// SPDX-License-Identifier: MIT
/// Messages that the protocol tests share.
#pragma once

#include <cmath>
#include <cstring>
#include <random>

#include "protocol/wire/codec.h"

namespace test {

inline protocol::Hello sample_hello(protocol::Role role) {
  protocol::Hello h;
  h.role = role;
  h.program = role == protocol::Role::Fluid ? "lbm" : "liggghts";
  h.program_version = "1.2.3";
  h.box_hi = {0.02, 0.06, 0.5};
  h.box_lo = {0.0, 0.0, -0.5};
  h.gravity = {0.0, -9.8, 0.0};
  h.step = role == protocol::Role::Fluid ? 2e-4 : 2e-5;
  h.solid_steps = 10;
  h.particles = role == protocol::Role::Solid ? std::optional<std::int64_t>(1) : std::nullopt;
  h.radius = protocol::Range{0.00125, 0.00125};
  h.density = protocol::Range{1250.0, 1250.0};
  h.subdomain_lo = h.box_lo;
  h.subdomain_hi = h.box_hi;
  h.sides.emplace().fill(protocol::SideWall::Whole);
  h.bodies = {"fix drum mesh/surface"};
  h.variables = {{"x_hi", "0.02"}, {"note", "two words"}};
  return h;
}

/// States of `count` particles with ids from `first_id`, full of digits.
inline protocol::StateBatch sample_states(std::int64_t interval, int count, int first_id = 1) {
  std::mt19937_64 random(static_cast<unsigned>(interval * 1000 + first_id));
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  protocol::StateBatch b{{interval, 2e-4 * static_cast<double>(interval), 0},
                         {2e-5, {0.0, 0.0, -0.5}, {0.02, 0.06, 0.5}},
                         {},
                         {},
                         {}};
  for (int i = 0; i < count; ++i) {
    protocol::State s;
    s.id = first_id + i;
    for (int k = 0; k < 3; ++k) {
      s.x[k] = 0.02 * unit(random);
      s.v[k] = unit(random) - 0.5;
      s.omega[k] = 1.0 / (1e-3 + unit(random));
    }
    b.states.push_back(s);
    b.shapes.push_back({s.id, 0.00125, 6.135923e-3, 4.8e-9, 1});
  }
  return b;
}

inline protocol::LoadBatch sample_loads(std::int64_t interval, int count, int first_id = 1) {
  const auto states = sample_states(interval, count, first_id);
  protocol::LoadBatch b{states.head, {}};
  for (const auto& s : states.states) b.loads.push_back({s.id, s.v, s.omega});
  return b;
}

template <class Record>
bool same_bits(const std::vector<Record>& a, const std::vector<Record>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Record)) == 0);
}

}  // namespace test
