// SPDX-License-Identifier: MIT
#include "discs.h"

#include <algorithm>
#include <cmath>

namespace {

constexpr std::int64_t kNextDisc = 1'000'000;  // what the ids of a clump's discs are apart

bool is_part(const bplbm_shape& shape) {
  return shape.carrier != BPLBM_ITSELF;
}

}  // namespace

void Discs::add(const bplbm_state& centre, std::int64_t epoch) {
  for (std::size_t j = 0; j < kind_.arms.size(); ++j) {
    bplbm_state& state = states.emplace_back(centre);
    bplbm_shape& shape = shapes.emplace_back(kind_.shapes[j]);
    state.id = shape.id = centre.id + kNextDisc * static_cast<std::int64_t>(j);
    shape.epoch = epoch;
    if (j > 0) shape.carrier = centre.id;
    for (int k = 0; k < 2; ++k) state.x[k] += kind_.arms[j][k];
  }
}

void Discs::remove(std::int64_t id) {
  std::erase_if(shapes, [id](const bplbm_shape& s) { return s.id == id || s.carrier == id; });
  std::erase_if(states, [&](const bplbm_state& s) {
    return std::ranges::none_of(shapes, [&](const bplbm_shape& kept) { return kept.id == s.id; });
  });
}

std::int64_t Discs::bodies() const {
  return std::ranges::count_if(shapes, [](const bplbm_shape& s) { return !is_part(s); });
}

void Discs::advance(int steps, std::span<const bplbm_load> loads) {
  Accelerations acceleration = accelerations(loads);
  for (int n = 0; n < steps; ++n) {
    kick(acceleration);
    drift();
    acceleration = accelerations(loads);
    kick(acceleration);
  }
  std::vector<std::int64_t> gone;
  for (std::size_t i = 0; i < states.size(); ++i)
    if (!put_into_box(states[i]) && !is_part(shapes[i])) gone.push_back(shapes[i].id);
  for (const std::int64_t id : gone) remove(id);
}

// ---- motion -------------------------------------------------------------------------------------

/// Of each record the one with which it moves: itself, or its clump's, which stands before it.
std::vector<std::size_t> Discs::movers() const {
  std::vector<std::size_t> all(shapes.size());
  for (std::size_t i = 0, body = 0; i < all.size(); ++i)
    all[i] = is_part(shapes[i]) ? body : (body = i);
  return all;
}

/// From a to b, in a periodic box to the nearest image [m].
Vec2 Discs::way(const bplbm_state& a, const bplbm_state& b) const {
  Vec2 d{};
  for (int k = 0; k < 2; ++k) {
    const double length = box_.high[k] - box_.low[k];
    d[k] = b.x[k] - a.x[k];
    if (box_.periodic[k]) d[k] -= length * std::round(d[k] / length);
  }
  return d;
}

/// Half a step of the velocities.
void Discs::kick(const Accelerations& a) {
  const auto mover = movers();
  for (std::size_t i = 0; i < states.size(); ++i) {
    bplbm_state& s = states[i];
    const bplbm_state& body = states[mover[i]];
    if (mover[i] == i) {
      for (int k = 0; k < 2; ++k) s.v[k] += 0.5 * step_ * a[i].of_place[k];
      s.omega[2] += 0.5 * step_ * a[i].spin;
    } else {
      const Vec2 arm = way(body, s);
      s.omega[2] = body.omega[2];
      s.v[0] = body.v[0] - body.omega[2] * arm[1];
      s.v[1] = body.v[1] + body.omega[2] * arm[0];
    }
  }
}

/// A step of the places; the discs of a clump turn about its centre.
void Discs::drift() {
  const std::vector<bplbm_state> before = states;
  const auto mover = movers();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const bplbm_state& body = states[mover[i]];
    if (mover[i] == i) {
      for (int k = 0; k < 2; ++k) states[i].x[k] += step_ * states[i].v[k];
      continue;
    }
    const Vec2 arm = way(before[mover[i]], before[i]);
    const double c = std::cos(step_ * body.omega[2]), s = std::sin(step_ * body.omega[2]);
    states[i].x[0] = body.x[0] + c * arm[0] - s * arm[1];
    states[i].x[1] = body.x[1] + s * arm[0] + c * arm[1];
  }
}

bool Discs::put_into_box(bplbm_state& s) const {
  for (int k = 0; k < 2; ++k) {
    const double length = box_.high[k] - box_.low[k];
    if (box_.periodic[k])
      s.x[k] -= length * std::floor((s.x[k] - box_.low[k]) / length);
    else if (s.x[k] < box_.low[k] || s.x[k] > box_.high[k])
      return false;
  }
  return true;
}

// ---- forces -------------------------------------------------------------------------------------

/// Of everything that moves by itself, from weight, loads, walls and contacts of discs.
Discs::Accelerations Discs::accelerations(std::span<const bplbm_load> loads) const {
  Accelerations a(states.size());
  const auto mover = movers();
  const auto touch = [&](std::size_t i, const Vec2& force) {
    const std::size_t body = mover[i];
    const Vec2 arm = way(states[body], states[i]);
    for (int k = 0; k < 2; ++k) a[body].of_place[k] += force[k] / shapes[body].mass;
    a[body].spin += (arm[0] * force[1] - arm[1] * force[0]) / shapes[body].inertia;
  };
  std::vector<std::size_t> discs;  // all that has a surface
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (mover[i] == i) {
      for (int k = 0; k < 2; ++k)
        a[i].of_place[k] += kind_.gravity[k] + loads[i].force[k] / shapes[i].mass;
      a[i].spin += loads[i].torque[2] / shapes[i].inertia;
    }
    if (kind_.arms.size() == 1 || mover[i] != i) discs.push_back(i);
  }
  for (std::size_t n = 0; n < discs.size(); ++n) {
    const std::size_t i = discs[n];
    touch(i, push_of_walls(i));
    for (std::size_t m = 0; m < n; ++m) {
      const std::size_t j = discs[m];
      if (mover[i] == mover[j]) continue;
      const Vec2 force = push_of_disc(i, j);
      touch(i, force);
      touch(j, {-force[0], -force[1]});
    }
  }
  return a;
}

/// Force of a contact along its normal: never a pull. @param approach  speed of approach
double Discs::push(double overlap, double approach) const {
  return overlap > 0.0 ? std::max(0.0, kind_.stiffness * overlap + kind_.damping * approach) : 0.0;
}

Vec2 Discs::push_of_walls(std::size_t i) const {
  Vec2 force{};
  const bplbm_state& s = states[i];
  for (int k = 0; k < 2; ++k)
    if (box_.walls[k])
      force[k] = push(shapes[i].radius - (s.x[k] - box_.low[k]), -s.v[k]) -
                 push(shapes[i].radius - (box_.high[k] - s.x[k]), s.v[k]);
  return force;
}

/// Of disc j on disc i.
Vec2 Discs::push_of_disc(std::size_t i, std::size_t j) const {
  const Vec2 n = way(states[j], states[i]);
  const double distance = std::hypot(n[0], n[1]);
  double approach = 0.0;
  for (int k = 0; k < 2; ++k) approach -= (states[i].v[k] - states[j].v[k]) * n[k] / distance;
  const double force = push(shapes[i].radius + shapes[j].radius - distance, approach);
  return {force * n[0] / distance, force * n[1] / distance};
}
