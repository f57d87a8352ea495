// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/observers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/coupling/scene_parameters.h"
#include "lbm_solver/coupling/shown_cells.h"

namespace lbm {
namespace {

constexpr std::int64_t kGuardSteps = 50;  // fluid steps between two looks at the whole field
constexpr double kProgressSeconds = 0.5;

double seconds_since(std::chrono::steady_clock::time_point t) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}

std::string duration_text(double seconds) {
  if (seconds < 100.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 6000.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

constexpr double kParted = 1.5;  // distance over sum of radii from which a broken bond is not drawn

/// A place in [lo, lo + length) that is `length` times a whole number away.
double wrapped(double x, double lo, double length) {
  if (x >= lo && x < lo + length) return x;
  const double inside = x - length * std::floor((x - lo) / length);
  return inside < lo + length ? inside : lo;  // rounding
}

/// Leaves the particles that the scene has chosen; all where it has chosen none.
void keep_chosen(const std::vector<std::int64_t>& ids, Particles::Everything& all) {
  if (ids.empty()) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < all.particles.size(); ++i) {
    if (std::find(ids.begin(), ids.end(), all.particles[i].state.id) == ids.end()) continue;
    all.particles[kept] = all.particles[i];
    all.loads[kept++] = all.loads[i];
  }
  all.particles.resize(kept);
  all.loads.resize(kept);
}

/// What a progress line says of grains and bonds.
std::string solid_text(const Particles* particles) {
  const std::string text =
      particles && particles->report() ? describe(*particles->report()) : std::string();
  return text.empty() ? text : ", " + text;
}

}  // namespace

Observers::Observers(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                     const std::string& folder, Log& log, std::int64_t first)
    : scene_(scene),
      plan_(plan),
      ranks_(ranks),
      log_(log),
      probe_times_(scene.output.probe_every, plan.interval()),
      folder_(folder),
      first_(first),
      end_(plan.intervals),
      guard_every_(std::max<std::int64_t>(1, kGuardSteps / plan.fluid_steps)),
      start_(std::chrono::steady_clock::now()),
      last_progress_(start_) {
  const double keep = time_of(first) - 0.5 * plan.interval();  // lines before this time
  intervals_done_ = first;
  if (scene.output.fields_every > 0.0) {
    field_times_.emplace(scene.output.fields_every, plan.interval());
    images_ = image_solids(scene, plan);
  }
  const bool flat = scene.box.dimension == 2;
  if (!scene.obstacles.empty()) obstacles_.emplace(scene, plan, ranks, folder, keep);
  if (HeldFlow::wanted_by(scene)) flow_.emplace(scene, plan, ranks, folder, keep);
  sensors_ = make_sensors(scene, plan, ranks, folder, keep);
  if (scene.output.average) average_.emplace(*scene.output.average, plan, ranks);
  if (scene.steady_below > 0.0) steady_.emplace(scene, plan, guard_every_ * plan.fluid_steps);
  if (ranks.rank() != 0) return;
  if (scene.coupling) probes_.emplace(folder, scene.box.dimension, keep);
  if (!scene.output.points.empty())
    points_.emplace(folder + "/points.csv",
                    flat ? "time [s],x [m],y [m],pressure [Pa],ux [m/s],uy [m/s]"
                         : "time [s],x [m],y [m],z [m],pressure [Pa],ux [m/s],uy [m/s],uz [m/s]",
                    keep);
  if (field_times_)
    fields_.emplace(folder, plan.units, scene.box.dimension, keep, ShownObstacles(scene));
}

std::int64_t Observers::next_look(std::int64_t state) const {
  std::int64_t next = (state / guard_every_ + 1) * guard_every_;
  if (obstacles_ || flow_ || !scene_.output.points.empty())
    next = std::min(next, probe_times_.next(state + 1));
  if (field_times_) next = std::min(next, field_times_->next(state + 1));
  if (average_) next = std::min(next, average_->next(state + 1));
  for (const auto& sensor : sensors_) next = std::min(next, sensor->next(state + 1));
  return next;
}

void Observers::at_state(std::int64_t state, Fluid& fluid, const Particles* particles, bool last) {
  // the run that goes on has looked at its first state, or does so when it is due
  if (last || (fresh_ && state == first_)) guard(state, fluid, particles);
  // Fields first: where they find the disk full, the loads' sums are still there to be kept.
  if (last ? field_times_.has_value() : draws_at(state))
    write_fields(time_of(state), fluid, particles);
  if (last || probe_times_.due(state)) {
    write_points(time_of(state), fluid);
    if (flow_) flow_->write(time_of(state), fluid);
    if (obstacles_) obstacles_->write(time_of(state));
  }
  measure(state, fluid, last);
  if (last && particles) write_particles(time_of(state), *particles);
  if (last && plan_.kernel.parameters.viscosity_table) report_viscosity(state, fluid);
}

/// Where the viscosity depends on the shear rate: how much of the fluid lies beyond its bounds.
void Observers::report_viscosity(std::int64_t state, const Fluid& fluid) {
  viscosity_ = viscosity_use(fluid, plan_.kernel.parameters);
  log_.say(
      state, "viscosity",
      "{:.3g} % of the fluid is at the bound of low shear rates, {:.3g} % at that of high ones; "
      "largest shear rate {:.4g} 1/s",
      100.0 * viscosity_->at_rest_bound, 100.0 * viscosity_->at_shear_bound,
      viscosity_->largest_shear / plan_.units.dt);
}

/// What the scene's sensors and its average want of a state.
void Observers::measure(std::int64_t state, Fluid& fluid, bool last) {
  for (const auto& sensor : sensors_)
    if (last || sensor->due(state)) sensor->write(time_of(state), fluid);
  if (!average_) return;
  if (average_->due(state)) average_->add(time_of(state), fluid);
  if (!last) return;
  const auto begin = std::chrono::steady_clock::now();
  average_->write(folder_, plan_.units);
  writing_["averages"] = seconds_since(begin);
}

void Observers::after_interval(std::int64_t state, Fluid& fluid, const Particles* particles) {
  intervals_done_ = state + 1;
  if ((state + 1) % guard_every_ == 0) guard(state + 1, fluid, particles);
  if (particles && probe_times_.due(state)) write_particles(time_of(state), *particles);
  if (seconds_since(last_progress_) > kProgressSeconds || intervals_done_ == end_)
    report_progress(state, particles);
}

Record Observers::save() const {
  Record record;
  record.set("max_speed", max_speed_);
  record.set("first_mass_excess", first_mass_excess_);
  record.set("mass_excess", mass_excess_);
  if (obstacles_) record.set("obstacle_loads", obstacles_->save());
  if (steady_) record.set("steady", steady_->save(ranks_));
  for (std::size_t i = 0; i < sensors_.size(); ++i)
    record.set("sensor_" + scene_.output.sensors[i].name, sensors_[i]->save());
  if (average_) record.set("average", average_->save());
  return record;
}

void Observers::move_to(const Decomposition& ranks) {
  ranks_ = ranks;
  for (const auto& sensor : sensors_) sensor->move_to(ranks);
  if (obstacles_) obstacles_->move_to(ranks);
  if (average_) average_->move_to(ranks);
}

void Observers::load(const Record& record) {
  fresh_ = false;
  max_speed_ = record.real("max_speed");
  first_mass_excess_ = record.real("first_mass_excess");
  mass_excess_ = record.real("mass_excess");
  if (obstacles_) obstacles_->load(record.part("obstacle_loads"));
  for (std::size_t i = 0; i < sensors_.size(); ++i)
    sensors_[i]->load(record.part("sensor_" + scene_.output.sensors[i].name));
  if (average_) average_->load(record.part("average"));
  // steady_below may be another one now, or new
  if (steady_ && record.parts().contains("steady")) steady_->load(record.part("steady"), ranks_);
}

void Observers::write_particles(double time, const Particles& particles) {
  Particles::Everything all = shown(particles);
  if (probes_ && !chosen_seen_) warn_of_absent(all.particles);
  if (probes_ && !buried_told_) warn_of_buried(time, all.particles);
  keep_chosen(scene_.output.probe_particles, all);
  if (probes_) probes_->write(time, all.particles, all.loads);
}

/// Once: particles in what moves.
void Observers::warn_of_buried(double time, std::span<const protocol::Particle> particles) {
  const std::string text = buried_text(scene_, particles, time, deep_starts_);
  if (text.empty()) return;
  buried_told_ = true;
  log_.say(std::llround(time / plan_.interval()), "warning", "{}", text);
}

/// Once: chosen particles that are not there when the first rows are written.
void Observers::warn_of_absent(std::span<const protocol::Particle> particles) {
  chosen_seen_ = true;
  std::string absent;
  for (const std::int64_t id : scene_.output.probe_particles)
    if (std::ranges::none_of(particles, [id](const auto& p) { return p.state.id == id; }))
      absent += fmt::format("{}{}", absent.empty() ? "" : ", ", id);
  if (absent.empty()) return;
  log_.say(
      first_, "warning",
      "output.probe_particles: no particle has the number {} so far ({} are there): probes.csv "
      "has no rows of it; LIGGGHTS numbers from 1 on",
      absent, particles.size());
}

void Observers::write_points(double time, Fluid& fluid) {
  for (const Vec3& x : scene_.output.points) {
    const auto c = fluid.at(plan_.units.to_lattice_position(x));
    const double pressure = (c.rho - 1.0) * plan_.units.pressure();
    const Vec3 u = c.u * plan_.units.velocity();
    if (!points_) continue;
    if (scene_.box.dimension == 2)
      points_->row({time, x.x(), x.y(), pressure, u.x(), u.y()});
    else
      points_->row({time, x.x(), x.y(), x.z(), pressure, u.x(), u.y(), u.z()});
  }
  if (points_) points_->flush();
}

/// Looks at every cell of a state.
void Observers::guard(std::int64_t state, Fluid& fluid, const Particles* particles) {
  const auto e = fluid.extremes();
  const bool flat = scene_.box.dimension == 2;
  const Vec3 cell(e.cell[0] + 0.5, e.cell[1] + 0.5, e.cell[2] + 0.5);
  const Vec3 x = plan_.units.origin + plan_.units.dx * cell;
  const std::string place = flat ? fmt::format("({:.6g}, {:.6g}) m", x.x(), x.y())
                                 : fmt::format("({:.6g}, {:.6g}, {:.6g}) m", x.x(), x.y(), x.z());
  const double particle =
      ranks_.max(particles ? particles->max_speed() / plan_.units.velocity() : 0.0);
  const double speed =
      e.finite ? std::max(e.max_speed, particle) : std::numeric_limits<double>::infinity();
  if (state > 0) speeds_.add(state * plan_.fluid_steps, speed);
  const auto why = [&] {
    auto all = particles ? particles->gather().particles : std::vector<protocol::Particle>();
    hide_hulls(all);
    const bool fluid_is_fastest = !(e.finite && particle > e.max_speed);
    return diagnosis(scene_, plan_, time_of(state),
                     fluid_is_fastest ? std::optional(x) : std::nullopt, speeds_, all,
                     deep_starts_);
  };
  if (!e.finite)
    throw NumericsError(
        fmt::format("interval {}: the fluid is not finite at {}.{}", state, place, why()));
  last_speed_ = e.max_speed;
  speed_known_ = speed_known_ || state > first_;
  max_speed_ = std::max(max_speed_, e.max_speed);
  mass_excess_ = e.mass_excess - fluid.mass_in();
  if (state == 0) first_mass_excess_ = mass_excess_;
  if (steady_) steady_->look(fluid);
  if (speed <= (warned_ ? kStopSpeed : 1.001 * kWarnSpeed)) return;
  const std::string who = e.max_speed > particle ? "the fluid at " + place : "a particle";
  const std::string what =
      fmt::format("{} moves at {:.4g} m/s = {:.3g} C", who, speed * plan_.units.velocity(), speed);
  if (speed > kStopSpeed)
    throw NumericsError(
        fmt::format("interval {}: {}, above {}.{}", state, what, kStopSpeed, why()));
  const std::string reason = why();  // the ranks gather the particles together
  log_.say(state, "warning", "{}, above {}: compressibility error; a run stops at {}.{}", what,
           kWarnSpeed, kStopSpeed, reason);
  warned_ = true;
}

/// Lines between the centres of bonded particles; across a periodic side there is none, nor where
/// a bond is broken and the two have parted.
void Observers::add_bonds(const std::vector<protocol::Particle>& particles,
                          const std::vector<protocol::Bond>& bonds, FieldFrame& frame) const {
  std::unordered_map<std::int64_t, const protocol::Particle*> by_id;
  for (const auto& p : particles) by_id.emplace(p.state.id, &p);
  const int d = scene_.box.dimension;
  for (const protocol::Bond& bond : bonds) {
    const auto a = by_id.find(bond.first), b = by_id.find(bond.second);
    if (a == by_id.end() || b == by_id.end()) continue;  // one has left the box
    const auto &x = a->second->state.x, &y = b->second->state.x;
    bool across = false;
    double squares = 0.0;
    for (int k = 0; k < d; ++k) {
      across = across || std::abs(x[k] - y[k]) > 0.5 * scene_.box.size[k];
      squares += (x[k] - y[k]) * (x[k] - y[k]);
    }
    const double touching = a->second->shape.radius + b->second->shape.radius;
    if (across || (bond.state != 0 && std::sqrt(squares) > kParted * touching)) continue;
    for (const auto* end : {&x, &y})
      frame.bond_ends.insert(frame.bond_ends.end(), end->begin(), end->begin() + d);
    frame.bond_state.push_back(static_cast<double>(bond.state));
  }
}

/// All particles, inside the box: LIGGGHTS wraps places at periodic sides only now and then.
Particles::Everything Observers::shown(const Particles& particles) const {
  Particles::Everything all = particles.gather();
  hide_hulls(all.particles);
  for (protocol::Particle& p : all.particles)
    for (int k = 0; k < scene_.box.dimension; ++k)
      if (scene_.box.sides[k] == SideKind::Periodic)
        p.state.x[k] = wrapped(p.state.x[k], scene_.box.origin[k], scene_.box.size[k]);
  return all;
}

void Observers::add_particles(const Particles& particles, FieldFrame& frame) const {
  Particles::Everything all = shown(particles);
  if (particles.report()) add_bonds(all.particles, particles.report()->list, frame);
  frame.particles = std::move(all.particles);
  frame.loads = std::move(all.loads);
}

void Observers::write_fields(double time, Fluid& fluid, const Particles* particles) {
  const auto begin = std::chrono::steady_clock::now();
  FieldFrame frame;
  frame.time = time;
  frame.cells = shown_cells(fluid, plan_, scene_.output.viscosity);
  if (!images_.empty() && ranks_.max(fields_ && fields_->at_first() ? 1.0 : 0.0) > 0.0)
    add_images(images_, fluid, frame.cells);
  if (fluid.cover()) frame.flux = mean_arrived_momentum(fluid) * plan_.units.velocity();
  if (particles) add_particles(*particles, frame);
  if (fields_)
    fields_->write(frame, ranks_);
  else
    send_fields(frame.cells, ranks_);
  writing_["fields"] += seconds_since(begin);
}

void Observers::report_progress(std::int64_t state, const Particles* particles) {
  last_progress_ = std::chrono::steady_clock::now();
  const double wall = seconds_since(start_);
  const double made = static_cast<double>(intervals_done_ - first_);
  const double done = static_cast<double>(intervals_done_) / static_cast<double>(end_);
  const double left = static_cast<double>(end_ - intervals_done_) * wall / made;
  const double updates =
      made * plan_.fluid_steps * plan_.domain.nx * plan_.domain.ny * plan_.domain.nz;
  log_.progress(done, fmt::format("{:>9} | progress | t = {:.4g} s, {:3.0f} %, {:.0f} million "
                                  "updates/s, {} left{}",
                                  state, time_of(intervals_done_), 100.0 * done,
                                  updates / wall * 1e-6, duration_text(left), speed_text()) +
                          solid_text(particles));
}

/// Of the last look at the whole field; before the first nothing is known.
std::string Observers::speed_text() const {
  if (!speed_known_) return {};
  return fmt::format(", Ma {:.3f}, max |u| {:.4g} m/s", last_speed_ * std::numbers::sqrt3,
                     last_speed_ * plan_.units.velocity());
}

Summary Observers::summary(double wall_seconds) const {
  Summary s;
  s.cells = static_cast<long>(plan_.domain.nx) * plan_.domain.ny * plan_.domain.nz;
  s.steps = static_cast<long>(intervals_done_) * plan_.fluid_steps;
  s.substeps = plan_.substeps;
  s.physical_seconds = time_of(intervals_done_);
  s.wall_seconds = wall_seconds;
  s.mlups = static_cast<double>(s.cells) * static_cast<double>(intervals_done_ - first_) *
            plan_.fluid_steps / wall_seconds * 1e-6;
  s.writing = writing_;
  s.ma_max = max_speed_ * std::numbers::sqrt3;
  s.ma_paper = max_speed_;
  s.re = plan_.reynolds;
  s.re_h = plan_.reynolds_cell;
  s.mass_drift = (mass_excess_ - first_mass_excess_) / static_cast<double>(s.cells);
  s.parameters = scene_parameters(scene_, plan_);
  if (flow_) flow_->describe(s.parameters);
  if (!viscosity_) return s;
  const double unit = plan_.units.dx * plan_.units.dx / plan_.units.dt;
  s.parameters.insert({{"share_at_rest_bound", viscosity_->at_rest_bound},
                       {"share_at_shear_bound", viscosity_->at_shear_bound},
                       {"shear_rate_max", viscosity_->largest_shear / plan_.units.dt},
                       {"mean_viscosity", viscosity_->mean_viscosity * unit}});
  return s;
}

}  // namespace lbm
