// SPDX-License-Identifier: MIT
/// A small solid program: soft discs with linear springs and dashpots, alone or as equal clumps, on
/// one rank. Everything that it needs comes as variables of the fluid's scene; it has no input
/// file.
///
///   F_n = k δ - γ v_n,  γ = 2 ξ √(m k), between discs and with walls; velocity Verlet, in which
///   the load of an interval acts in each of its substeps, its first half-step included.
///
/// The variable `clump`, "x,y,z,r:x,y,z,r…" in metres about any point, makes one of each particle.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <sstream>

#include "protocol/program/mpi_start.h"
#include "protocol/program/program.h"
#include "protocol/program/solid_parts.h"
#include "protocol/program/watch.h"
#include "protocol/transport/mpi_channel.h"
#include "protocol/wire/ball_union.h"
#include "protocol/wire/clumps.h"
#include "protocol/wire/codec.h"
#include "protocol/wire/session.h"
#include "tools/engines/reference/offer.h"

namespace {

using namespace protocol;
using engine::Offer;

struct Box {
  Vec3 lo{}, hi{};
  bool periodic[2]{}, walls[2]{};
};

class Discs {
 public:
  Discs(const Hello& fluid, const Offer& offer) : offer_(offer) {
    const char* axis[] = {"x", "y", "z"};
    for (int k = 0; k < 3; ++k) {
      box_.lo[k] = offer.number(fmt::format("{}_lo", axis[k]));
      box_.hi[k] = offer.number(fmt::format("{}_hi", axis[k]));
      if (k == 2) break;
      box_.periodic[k] = offer.text(fmt::format("boundary_{}", axis[k])) == "p";
      box_.walls[k] = offer.number(fmt::format("walls_{}", axis[k])) != 0.0;
    }
    const double radius = 0.5 * offer.number("diameter_max");
    const double mass =
        offer.number("density_max") * std::numbers::pi * radius * radius * offer.number("depth");
    shapes_of_one_ = {{0, radius, mass, 0.5 * mass * radius * radius, 1}};
    arms_ = {Vec3{}};
    if (offer.has("clump")) make_clump(offer.text("clump"));
    step_ = offer.number("solid_step");
    stiffness_ = offer.number_or("contact_stiffness", 1e5);
    damping_ = 2.0 * offer.number_or("damping_ratio", 0.5) * std::sqrt(mass * stiffness_);
    const double g = offer.number("gravity");
    gravity_ = {g * offer.number("gravity_x"), g * offer.number("gravity_y"), 0.0};
    if (fluid.first_interval > 0)
      read(offer.text("restart_file"));
    else
      insert(0);
  }

  /// Takes particles out of the box and puts others into it, as the scene says for an interval.
  void insert(int interval) {
    for (int i = 1;; ++i) {
      const std::string p = fmt::format("particle{}_", i);
      if (offer_.number_or(p + "x", NAN) != offer_.number_or(p + "x", NAN)) return;
      const auto id = static_cast<std::int64_t>(offer_.number_or(p + "id", i));
      if (offer_.number_or(p + "until", -1.0) == interval) remove(id);
      if (offer_.number_or(p + "interval", 0.0) != interval) continue;
      State s;
      s.x = {offer_.number(p + "x"), offer_.number(p + "y"), 0.0};
      s.v = {offer_.number_or(p + "vx", 0.0), offer_.number_or(p + "vy", 0.0), 0.0};
      add(id, s, interval);
    }
  }
  /// Discs and clumps, without the discs of clumps.
  std::int64_t bodies() const {
    return std::ranges::count_if(shapes, [](const Shape& s) { return !is_part(s); });
  }

  /// A checkpoint is a frame of states, as it would go to the fluid.
  Bytes checkpoint(const StepHeader& head) const {
    return encode(StateBatch{head, {}, states, shapes, {}});
  }
  /// Every path of the discs is decided by places and velocities: a restart goes on to the bit.
  void read(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    try {
      StateBatch batch = decode<StateBatch>({begin, begin + text.size()});
      states = std::move(batch.states);
      shapes = std::move(batch.shapes);
    } catch (const BadMessage& error) {
      throw ProgramError(file + " is no checkpoint of this engine: " + error.what(), kBadInput);
    }
  }

  /// Some steps under one load each; what leaves an open box is gone.
  void advance(std::uint32_t steps, std::span<const Load> loads) {
    std::vector<Acceleration> acceleration = accelerations(loads);
    for (std::uint32_t n = 0; n < steps; ++n) {
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

  const Box& box() const { return box_; }
  const Vec3& gravity() const { return gravity_; }
  double step() const { return step_; }
  std::vector<State> states;
  std::vector<Shape> shapes;

 private:
  struct Acceleration {
    Vec3 of_place{};    ///< [m/s²]
    double spin = 0.0;  ///< [rad/s²]
  };

  /// Discs in the frame of their clump, whose centre is that of their union.
  void make_clump(std::string text) {
    std::vector<Ball> balls;
    const auto commas = std::ranges::count(text, ','), colons = std::ranges::count(text, ':');
    for (char& c : text)
      if (c == ',' || c == ':') c = ' ';
    std::istringstream numbers(text);
    for (Ball b; numbers >> b.x[0] >> b.x[1] >> b.x[2] >> b.radius;) balls.push_back(b);
    const auto n = std::ssize(balls);
    const double most = std::max(box_.hi[0] - box_.lo[0], box_.hi[1] - box_.lo[1]);
    const bool fit = std::ranges::all_of(balls, [most](const Ball& b) {
      return b.radius > 0.0 && std::max({b.radius, std::abs(b.x[0]), std::abs(b.x[1])}) <= most;
    });
    if (n == 0 || !numbers.eof() || commas != 3 * n || colons != n - 1 || !fit)
      throw ProgramError("the variable 'clump' = '" + offer_.text("clump") +
                             "' is no list of x,y,z,r:x,y,z,r… with radii above 0, in a clump no "
                             "larger than the box; correct [particles.variables]",
                         kBadInput);
    const double depth = offer_.number("depth");
    const Vec3 centre = moments_of_union(balls, 2, depth).centroid;
    for (Ball& b : balls)
      for (int k = 0; k < 2; ++k) b.x[k] -= centre[k];
    const UnionMoments moments = moments_of_union(balls, 2, depth);
    Shape body = shapes_of_one_[0];
    body.radius = bounding_radius(balls);
    body.volume = moments.volume;
    body.mass = offer_.number("density_max") * moments.volume;
    body.inertia = body.mass * (moments.second[0] + moments.second[1]);
    shapes_of_one_ = {body};
    for (const Ball& b : balls) {
      shapes_of_one_.push_back({0, b.radius, 0.0, 0.0, 1});
      arms_.push_back(b.x);
    }
  }

  /// A disc, or a clump and its discs.
  void add(std::int64_t id, const State& centre, int interval) {
    for (std::size_t j = 0; j < arms_.size(); ++j) {
      states.push_back(centre);
      shapes.push_back(shapes_of_one_[j]);
      states.back().id = shapes.back().id = id + 1'000'000 * static_cast<std::int64_t>(j);
      shapes.back().epoch = interval;
      if (j > 0) shapes.back().carrier = id;
      for (int k = 0; k < 2; ++k) states.back().x[k] += arms_[j][k];
    }
  }
  void remove(std::int64_t id) {
    std::erase_if(shapes, [id](const Shape& s) { return s.id == id || s.carrier == id; });
    std::erase_if(states, [&](const State& s) {
      return std::ranges::none_of(shapes, [&](const Shape& kept) { return kept.id == s.id; });
    });
  }

  /// Of each record the one with which it moves: itself, or its clump's, which stands before it.
  std::vector<std::size_t> movers() const {
    std::vector<std::size_t> all(shapes.size());
    for (std::size_t i = 0, body = 0; i < all.size(); ++i)
      all[i] = is_part(shapes[i]) ? body : (body = i);
    return all;
  }
  /// From a to b, in a periodic box the nearest image [m].
  Vec3 way(const Vec3& a, const Vec3& b) const {
    Vec3 d{};
    for (int k = 0; k < 2; ++k) {
      const double length = box_.hi[k] - box_.lo[k];
      d[k] = b[k] - a[k];
      if (box_.periodic[k]) d[k] -= length * std::round(d[k] / length);
    }
    return d;
  }

  /// Half a step of the velocities.
  void kick(std::span<const Acceleration> a) {
    const auto mover = movers();
    for (std::size_t i = 0; i < states.size(); ++i) {
      State& s = states[i];
      const State& body = states[mover[i]];
      if (mover[i] == i) {
        for (int k = 0; k < 2; ++k) s.v[k] += 0.5 * step_ * a[i].of_place[k];
        s.omega[2] += 0.5 * step_ * a[i].spin;
      } else {
        const Vec3 arm = way(body.x, s.x);
        s.omega = body.omega;
        s.v = {body.v[0] - body.omega[2] * arm[1], body.v[1] + body.omega[2] * arm[0], 0.0};
      }
    }
  }
  /// A step of the places; the discs of a clump turn about its centre.
  void drift() {
    const std::vector<State> before = states;
    const auto mover = movers();
    for (std::size_t i = 0; i < states.size(); ++i) {
      const State& body = states[mover[i]];
      const Vec3 arm = way(before[mover[i]].x, before[i].x);
      const double c = std::cos(step_ * body.omega[2]), s = std::sin(step_ * body.omega[2]);
      if (mover[i] == i)
        for (int k = 0; k < 2; ++k) states[i].x[k] += step_ * states[i].v[k];
      else
        states[i].x = {body.x[0] + c * arm[0] - s * arm[1], body.x[1] + s * arm[0] + c * arm[1],
                       0.0};
    }
  }

  /// Force of a contact along its normal: never a pull. @param approach  speed of approach
  double push(double overlap, double approach) const {
    return overlap > 0.0 ? std::max(0.0, stiffness_ * overlap + damping_ * approach) : 0.0;
  }

  /// Of everything that moves by itself, from weight, loads, walls and contacts of discs.
  std::vector<Acceleration> accelerations(std::span<const Load> loads) const {
    std::vector<Acceleration> a(states.size());
    const auto mover = movers();
    const auto touch = [&](std::size_t i, const Vec3& force) {
      const std::size_t body = mover[i];
      const Vec3 arm = way(states[body].x, states[i].x);
      for (int k = 0; k < 2; ++k) a[body].of_place[k] += force[k] / shapes[body].mass;
      a[body].spin += (arm[0] * force[1] - arm[1] * force[0]) / shapes[body].inertia;
    };
    std::vector<std::size_t> discs;  // all that has a surface
    for (std::size_t i = 0; i < states.size(); ++i) {
      if (mover[i] == i) {
        for (int k = 0; k < 2; ++k)
          a[i].of_place[k] += gravity_[k] + loads[i].force[k] / shapes[i].mass;
        a[i].spin += loads[i].torque[2] / shapes[i].inertia;
      }
      if (arms_.size() == 1 || mover[i] != i) discs.push_back(i);
    }
    for (std::size_t n = 0; n < discs.size(); ++n) {
      const std::size_t i = discs[n];
      touch(i, push_of_walls(i));
      for (std::size_t m = 0; m < n; ++m) {
        const std::size_t j = discs[m];
        if (mover[i] == mover[j]) continue;
        const Vec3 force = push_of_disc(i, j);
        touch(i, force);
        touch(j, {-force[0], -force[1], 0.0});
      }
    }
    return a;
  }
  Vec3 push_of_walls(std::size_t i) const {
    Vec3 force{};
    const State& s = states[i];
    for (int k = 0; k < 2; ++k)
      if (box_.walls[k])
        force[k] = push(shapes[i].radius - (s.x[k] - box_.lo[k]), -s.v[k]) -
                   push(shapes[i].radius - (box_.hi[k] - s.x[k]), s.v[k]);
    return force;
  }
  /// Of disc j on disc i.
  Vec3 push_of_disc(std::size_t i, std::size_t j) const {
    const Vec3 n = way(states[j].x, states[i].x);
    const double distance = std::hypot(n[0], n[1]);
    double approach = 0.0;
    for (int k = 0; k < 2; ++k) approach -= (states[i].v[k] - states[j].v[k]) * n[k] / distance;
    const double force = push(shapes[i].radius + shapes[j].radius - distance, approach);
    return {force * n[0] / distance, force * n[1] / distance, 0.0};
  }

  bool put_into_box(State& s) const {
    for (int k = 0; k < 2; ++k) {
      const double length = box_.hi[k] - box_.lo[k];
      if (box_.periodic[k])
        s.x[k] -= length * std::floor((s.x[k] - box_.lo[k]) / length);
      else if (s.x[k] < box_.lo[k] || s.x[k] > box_.hi[k])
        return false;
    }
    return true;
  }

  const Offer& offer_;
  Box box_;
  std::vector<Shape> shapes_of_one_;  ///< a disc, or a clump and its discs
  std::vector<Vec3> arms_;            ///< of these from the centre [m]
  Vec3 gravity_{};
  double step_ = 0.0, stiffness_ = 0.0, damping_ = 0.0;
};

/// From what this program was told to do, not a copy of the fluid's.
Hello handshake(const Hello& fluid, const Offer& offer, const Discs& discs) {
  Hello mine;
  mine.role = Role::Solid;
  mine.program = "reference_engine";
  mine.program_version = BPLBM_VERSION;
  mine.dimension = 2;
  mine.box_lo = discs.box().lo;
  mine.box_hi = discs.box().hi;
  mine.periodic = {discs.box().periodic[0], discs.box().periodic[1], 1};
  mine.depth = offer.number("depth");
  mine.gravity = discs.gravity();
  mine.buoyancy = fluid.buoyancy == Buoyancy::None ? Buoyancy::None : Buoyancy::ByFluid;
  mine.step = discs.step();
  mine.solid_steps = static_cast<std::uint32_t>(offer.number("substeps"));
  mine.particles = discs.bodies();
  mine.first_interval = fluid.first_interval;
  mine.features = kCheckpoints;
  mine.sides.emplace();
  for (int k = 0; k < 2; ++k)
    if (discs.box().walls[k]) (*mine.sides)[2 * k] = (*mine.sides)[2 * k + 1] = SideWall::Whole;
  return mine;
}

void run(Channel& channel) {
  SolidSession session(channel, 60.0);
  limit_waits(session.timeout());
  const Hello& fluid = session.fluid();
  const Offer offer(fluid);
  Discs discs(fluid, offer);
  const Hello mine = handshake(fluid, offer, discs);
  session.agree(mine);
  SolidParts parts = SolidParts::of(fluid);
  StepHeader head{fluid.first_interval, 0.0, kContinue};
  for (;; ++head.interval) {
    head.time = static_cast<double>(head.interval) * mine.step * mine.solid_steps;
    if (head.interval > fluid.first_interval) discs.insert(static_cast<int>(head.interval));
    if (signalled()) head.flags |= kStopWished;
    if (head.flags & kCheckpoint) parts.keep(head.interval, discs.checkpoint(head));
    const auto reply = session.exchange(head, discs.states, discs.shapes);
    if (head.flags & kLast) return;
    head.flags = (reply.flags & kStop ? kLast : 0U) | (reply.flags & kCheckpoint);
    discs.advance(mine.solid_steps, reply.loads);
  }
}

}  // namespace

int main(int argc, char** argv) {
  {
    const MpiStart bounded("reference_engine");
    MPI_Init(&argc, &argv);
  }
  catch_signals();
  std::unique_ptr<Channel> channel;
  World world;
  int code = kOk;
  try {
    world = connect(Role::Solid);
    if (!world.coupled())
      throw ProgramError(
          "no fluid program was started beside it; start: mpirun -np 1 lbm scene.toml : -np 1 "
          "reference_engine",
          kBadInput);
    channel = make_mpi_channel(world, Role::Solid);
    run(*channel);
  } catch (const std::exception& error) {
    code = leave_after(error, "reference_engine", channel.get());
  }
  return finish(code, "reference_engine", channel, world.local);
}
