// SPDX-License-Identifier: MIT
/// A small solid program: soft discs with linear springs and dashpots, on one rank. Everything that
/// it needs comes as variables of the fluid's scene; it has no input file.
///
///   F_n = k δ - γ v_n,  γ = 2 ξ √(m k), between discs and with walls; velocity Verlet, in which
///   the load of an interval acts in each of its substeps, its first half-step included.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>

#include "protocol/program/program.h"
#include "protocol/program/solid_parts.h"
#include "protocol/program/watch.h"
#include "protocol/transport/mpi_channel.h"
#include "protocol/wire/codec.h"
#include "protocol/wire/numbers.h"
#include "protocol/wire/session.h"

namespace {

using namespace protocol;

/// Numbers and texts that the fluid offers.
class Offer {
 public:
  explicit Offer(const Hello& fluid) {
    for (const Variable& v : fluid.variables) values_[v.name] = v.value;
  }
  double number(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end())
      throw ProgramError(fmt::format("the fluid offers no variable '{}'", name), kBadInput);
    const auto value = to_number<double>(found->second);
    if (!value)
      throw ProgramError(fmt::format("the fluid's variable '{}' = '{}' is no number; correct "
                                     "[particles.variables] of the scene",
                                     name, found->second),
                         kBadInput);
    return *value;
  }
  double number_or(const std::string& name, double otherwise) const {
    return values_.contains(name) ? number(name) : otherwise;
  }
  std::string text(const std::string& name) const { return values_.at(name); }

 private:
  std::map<std::string, std::string> values_;
};

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
    shape_ = {0, radius, mass, 0.5 * mass * radius * radius, 1};
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
      s.id = id;
      s.x = {offer_.number(p + "x"), offer_.number(p + "y"), 0.0};
      s.v = {offer_.number_or(p + "vx", 0.0), offer_.number_or(p + "vy", 0.0), 0.0};
      states.push_back(s);
      shapes.push_back(shape_);
      shapes.back().id = id;
      shapes.back().epoch = interval;
    }
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
    std::vector<Vec3> acceleration = accelerations(loads);
    for (std::uint32_t n = 0; n < steps; ++n) {
      for (std::size_t i = 0; i < states.size(); ++i)
        for (int k = 0; k < 2; ++k) {
          states[i].v[k] += 0.5 * step_ * acceleration[i][k];
          states[i].x[k] += step_ * states[i].v[k];
        }
      acceleration = accelerations(loads);
      for (std::size_t i = 0; i < states.size(); ++i) {
        for (int k = 0; k < 2; ++k) states[i].v[k] += 0.5 * step_ * acceleration[i][k];
        states[i].omega[2] += step_ * loads[i].torque[2] / shapes[i].inertia;
      }
    }
    for (std::size_t i = states.size(); i-- > 0;)
      if (!put_into_box(states[i])) {
        states.erase(states.begin() + static_cast<std::ptrdiff_t>(i));
        shapes.erase(shapes.begin() + static_cast<std::ptrdiff_t>(i));
      }
  }

  const Box& box() const { return box_; }
  const Vec3& gravity() const { return gravity_; }
  double step() const { return step_; }
  std::vector<State> states;
  std::vector<Shape> shapes;

 private:
  void remove(std::int64_t id) {
    std::erase_if(states, [id](const State& s) { return s.id == id; });
    std::erase_if(shapes, [id](const Shape& s) { return s.id == id; });
  }

  /// Force of a contact along its normal: never a pull. @param approach  speed of approach
  double push(double overlap, double approach) const {
    return overlap > 0.0 ? std::max(0.0, stiffness_ * overlap + damping_ * approach) : 0.0;
  }

  std::vector<Vec3> accelerations(std::span<const Load> loads) const {
    std::vector<Vec3> a(states.size());
    for (std::size_t i = 0; i < states.size(); ++i) {
      const State& s = states[i];
      const double r = shapes[i].radius, m = shapes[i].mass;
      for (int k = 0; k < 2; ++k) {
        a[i][k] += gravity_[k] + loads[i].force[k] / m;
        if (!box_.walls[k]) continue;
        a[i][k] += push(r - (s.x[k] - box_.lo[k]), -s.v[k]) / m;
        a[i][k] -= push(r - (box_.hi[k] - s.x[k]), s.v[k]) / m;
      }
      for (std::size_t j = 0; j < i; ++j) {
        Vec3 n{};
        for (int k = 0; k < 2; ++k) {
          n[k] = s.x[k] - states[j].x[k];
          const double length = box_.hi[k] - box_.lo[k];
          if (box_.periodic[k]) n[k] -= length * std::round(n[k] / length);
        }
        const double distance = std::hypot(n[0], n[1]);
        const double approach =
            -((s.v[0] - states[j].v[0]) * n[0] + (s.v[1] - states[j].v[1]) * n[1]) / distance;
        const double force = push(r + shapes[j].radius - distance, approach);
        for (int k = 0; k < 2; ++k) {
          a[i][k] += force * n[k] / distance / m;
          a[j][k] -= force * n[k] / distance / shapes[j].mass;
        }
      }
    }
    return a;
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
  Shape shape_;
  Vec3 gravity_{};
  double step_ = 0.0, stiffness_ = 0.0, damping_ = 0.0;
};

void run(Channel& channel) {
  SolidSession session(channel, 60.0);
  limit_waits(session.timeout());
  const Hello& fluid = session.fluid();
  const Offer offer(fluid);
  Discs discs(fluid, offer);
  Hello hello;  // from what this program was told to do, not a copy of the fluid's
  hello.role = Role::Solid;
  hello.program = "reference_engine";
  hello.program_version = BPLBM_VERSION;
  hello.dimension = 2;
  hello.box_lo = discs.box().lo;
  hello.box_hi = discs.box().hi;
  hello.periodic = {discs.box().periodic[0], discs.box().periodic[1], 1};
  hello.depth = offer.number("depth");
  hello.gravity = discs.gravity();
  hello.buoyancy = fluid.buoyancy == Buoyancy::None ? Buoyancy::None : Buoyancy::ByFluid;
  hello.step = discs.step();
  hello.solid_steps = static_cast<std::uint32_t>(offer.number("substeps"));
  hello.particles = static_cast<std::int64_t>(discs.states.size());
  hello.first_interval = fluid.first_interval;
  hello.features = kCheckpoints;
  hello.sides.emplace();
  for (int k = 0; k < 2; ++k)
    if (discs.box().walls[k]) (*hello.sides)[2 * k] = (*hello.sides)[2 * k + 1] = SideWall::Whole;
  session.agree(hello);
  SolidParts parts = SolidParts::of(fluid);
  StepHeader head{fluid.first_interval, 0.0, kContinue};
  for (;; ++head.interval) {
    head.time = static_cast<double>(head.interval) * hello.step * hello.solid_steps;
    if (head.interval > fluid.first_interval) discs.insert(static_cast<int>(head.interval));
    if (head.flags & kCheckpoint) parts.keep(head.interval, discs.checkpoint(head));
    const auto reply = session.exchange(head, discs.states, discs.shapes);
    if (head.flags & kLast) return;
    head.flags = (reply.flags & kStop ? kLast : 0U) | (reply.flags & kCheckpoint);
    discs.advance(hello.solid_steps, reply.loads);
  }
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
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
