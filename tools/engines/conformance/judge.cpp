// SPDX-License-Identifier: MIT
#include "tools/engines/conformance/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "protocol/wire/routing.h"

namespace conformance {

using namespace protocol;

namespace {

constexpr double kReach = 0.01;  // of the fluid beyond a particle [m]

class Offer {
 public:
  explicit Offer(std::vector<Variable>& to) : to_(to) {}
  void operator()(const std::string& name, double value) { text(name, fmt::format("{}", value)); }
  void text(const std::string& name, const std::string& value) { to_.push_back({name, value}); }

 private:
  std::vector<Variable>& to_;
};

void offer_box(const Hello& h, Offer& offer) {
  const char* axis[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    offer(fmt::format("{}_lo", axis[k]), h.box_lo[k]);
    offer(fmt::format("{}_hi", axis[k]), h.box_hi[k]);
    offer.text(fmt::format("boundary_{}", axis[k]), h.periodic[k] ? "p" : "f");
    offer(fmt::format("walls_{}", axis[k]), 0);  // the sides are open
  }
}

void offer_discs(const std::vector<Start>& discs, Offer& offer) {
  offer("particles", static_cast<double>(discs.size()));
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const Start& d = discs[i];
    const std::string p = fmt::format("particle{}_", i + 1);
    offer(p + "x", d.x);
    offer(p + "y", d.y);
    offer(p + "z", 0.0);
    offer(p + "vx", d.vx);
    offer(p + "vy", d.vy);
    offer(p + "interval", d.interval);
    offer(p + "until", d.until);
    offer(p + "id", d.id ? d.id : static_cast<double>(i + 1));
  }
}

void offer_clump(const Scene& scene, Offer& offer) {
  const UnionMoments whole = scene.clumps ? scene.clump() : UnionMoments{};
  const double mass = scene.density * whole.volume;
  offer("clump_mass", mass);
  offer("clump_inertia", mass * (whole.second[0] + whole.second[1]));
  if (!scene.clumps) return;
  const auto disc = [](const double(&d)[3]) { return fmt::format("{},{},0,{}", d[0], d[1], d[2]); };
  offer.text("clump", disc(kClump[0]) + ":" + disc(kClump[1]));
}

}  // namespace

void expect(bool good, const std::string& what) {
  if (!good) throw Wrong(what);
}
void expect_near(double value, double exact, double tolerance, const std::string& what) {
  expect(std::abs(value - exact) <= tolerance,
         fmt::format("{}: {:.17g} instead of {:.17g}", what, value, exact));
}

Load nothing(int, const Particle& p) {
  return {p.state.id, {}, {}};
}
Load pushed(int k, const Particle& p) {
  return {p.state.id, {0.25 * (k + 1), -0.5 * (k + 1), 0.0}, {0.0, 0.0, 0.01 * (k + 1)}};
}

double Scene::mass() const {
  return density * std::numbers::pi * kRadius * kRadius * depth;
}

UnionMoments Scene::clump() const {
  std::vector<Ball> discs;
  for (const auto& [x, y, radius] : kClump) discs.push_back({.x = {x, y, 0.0}, .radius = radius});
  return moments_of_union(discs, 2, depth);
}

Judge::Judge(Channel& channel, MPI_Comm local, std::string folder, double patience)
    : channel_(channel), local_(local), folder_(std::move(folder)), patience_(patience) {
  MPI_Comm_rank(local, &rank_);
  MPI_Comm_size(local, &ranks_);
}

Hello Judge::hello(const Scene& scene) const {
  Hello h;
  h.program = "bplbm-conformance";
  h.program_version = BPLBM_VERSION;
  h.box_lo = {0.0, 0.0, -0.5 * scene.depth};
  h.box_hi = {1.0, 1.0, 0.5 * scene.depth};
  h.periodic = {scene.periodic, scene.periodic, 1};
  h.depth = scene.depth;
  h.step = kInterval;
  h.solid_steps = 10;
  h.radius = Range{kRadius, kRadius};
  h.density = Range{scene.density, scene.density};
  h.subdomain_lo = h.box_lo;
  h.subdomain_hi = h.box_hi;
  h.reach = kReach;
  Offer offer(h.variables);
  offer_box(h, offer);
  const double timeout = scene.timeout > 0.0 ? scene.timeout : patience_;
  for (const auto& [name, value] : {std::pair{"depth", scene.depth},
                                    {"dimension", 2.0},
                                    {"gravity", 0.0},
                                    {"gravity_x", 0.0},
                                    {"gravity_y", -1.0},
                                    {"gravity_z", 0.0},
                                    {"solid_step", kInterval / 10},
                                    {"substeps", 10.0},
                                    {"solid_steps_total", 100000.0},
                                    {"diameter_min", 2 * kRadius},
                                    {"diameter_max", 2 * kRadius},
                                    {"density_min", scene.density},
                                    {"density_max", scene.density},
                                    {"contact_stiffness", 1e5},
                                    {"damping_ratio", 0.1},
                                    {"coupling_timeout", timeout},
                                    {"restart", 0.0}})
    offer(name, value);
  offer.text("checkpoint", folder_ + "/checkpoint");
  offer.text("out_folder", folder_);
  offer.text("restart_file", "none");
  offer_discs(scene.discs, offer);
  offer_clump(scene, offer);
  return h;
}

namespace {

/// The part of a rank of several, cut in x.
Hello part_of(Hello h, int rank, int ranks) {
  const double lo = h.box_lo[0], length = h.box_hi[0] - lo;
  h.subdomain_lo[0] = lo + length * rank / ranks;
  h.subdomain_hi[0] = lo + length * (rank + 1) / ranks;
  return h;
}

bool same(const Particle& a, const Particle& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

Hello Judge::part(const Hello& whole) const {
  return part_of(whole, rank_, ranks_);
}

/// How many fluid ranks a particle touches.
int Judge::sharing(const Particle& p) const {
  return static_cast<int>(std::count_if(parts_.begin(), parts_.end(), [&](const Hello& part) {
    return touches(part, p.state.x, p.shape.radius);
  }));
}

/// All particles, by id, from those of this rank.
std::vector<Particle> Judge::together(const std::vector<Particle>& mine) const {
  const int bytes = static_cast<int>(mine.size() * sizeof(Particle));
  std::vector<int> sizes(ranks_), places(ranks_);
  MPI_Allgather(&bytes, 1, MPI_INT, sizes.data(), 1, MPI_INT, local_);
  int total = 0;
  for (int r = 0; r < ranks_; total += sizes[r++]) places[r] = total;
  std::vector<Particle> all(total / sizeof(Particle));
  MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, all.data(), sizes.data(), places.data(), MPI_BYTE,
                 local_);
  const auto by_id = [](const Particle& a, const Particle& b) { return a.state.id < b.state.id; };
  std::stable_sort(all.begin(), all.end(), by_id);
  for (std::size_t i = 1; i < all.size(); ++i)
    if (all[i].state.id == all[i - 1].state.id)
      expect(same(all[i], all[i - 1]),
             fmt::format("fluid ranks got different states or shapes of particle {}",
                         all[i].state.id));
  all.erase(std::unique(all.begin(), all.end(), same), all.end());
  for (const Particle& p : all) {
    const bool here = std::any_of(mine.begin(), mine.end(),
                                  [&](const Particle& q) { return q.state.id == p.state.id; });
    expect(here || !touches(parts_[rank_], p.state.x, p.shape.radius),
           fmt::format("particle {} at ({:.6g}, {:.6g}) m was not sent to fluid rank {}, which it "
                       "touches",
                       p.state.id, p.state.x[0], p.state.x[1], rank_));
  }
  return all;
}

void Judge::converse(const Hello& hello, int intervals, const Loads& load, const Look& look,
                     std::uint32_t flag_at_two) {
  parts_.clear();
  for (int r = 0; r < ranks_; ++r) parts_.push_back(part_of(hello, r, ranks_));
  FluidSession session(channel_, parts_[rank_], patience_);
  const Hello& solid = session.agree();
  expect(solid.role == Role::Solid, "its handshake does not say that it is a solid");
  for (int k = 0;; ++k) {
    const Arrival& arrival = session.receive();
    expect(!arrival.goodbye, "it left: " + arrival.goodbye.value_or(""));
    const bool last = k == intervals;
    expect(((arrival.head.flags & kLast) != 0) == last,
           fmt::format("interval {}: it says {} the last", k, last ? "not" : "too early"));
    expect(((arrival.head.flags & kCheckpoint) != 0) == (k == 3 && flag_at_two == kCheckpoint),
           fmt::format("interval {}: checkpoint not written when asked, or unasked", k));
    look(k, together(arrival.particles));
    if (last) return;
    before_answer(k);
    std::vector<Load> loads;
    for (const Particle& p : arrival.particles) {
      Load part = load(k, p);
      const double share = 1.0 / std::max(1, sharing(p));
      for (int a = 0; a < 3; ++a) {
        part.force[a] *= share;
        part.torque[a] *= share;
      }
      loads.push_back(part);
    }
    session.answer(loads, (k + 1 == intervals ? kStop : kContinue) | (k == 2 ? flag_at_two : 0U));
  }
}

namespace {
struct Reached {};
}  // namespace

void Judge::converse_until(const Hello& hello, int interval) {
  try {
    expect_passes([&] {
      converse(hello, interval + 1, nothing, [=](int k, const auto&) {
        if (k == interval) throw Reached();
      });
    });
  } catch (const Reached&) {
  }
}

void Judge::expect_farewell(const std::string& after) const {
  const double seconds = 0.3 * patience_;
  const Ending ending = channel_.await_farewell(seconds);
  if (ending.fault) throw PeerFault(*ending.fault);
  expect(ending.missing.empty(),
         fmt::format("rank {} of it does not say farewell within {} s after {}",
                     ending.missing.empty() ? 0 : ending.missing[0], seconds, after));
}

}  // namespace conformance
