// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/observers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "lbm_solver/base/errors.h"

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

}  // namespace

void PartClock::charge(const char* part) {
  const auto now = Clock::now();
  seconds_[part] += std::chrono::duration<double>(now - last_).count();
  last_ = now;
}

double PartClock::total() const {
  return std::chrono::duration<double>(last_ - start_).count();
}

Observers::Observers(const Scene& scene, const Plan& plan, const std::string& folder, Log& log,
                     std::int64_t first)
    : scene_(scene),
      plan_(plan),
      log_(log),
      guard_every_(std::max<std::int64_t>(1, kGuardSteps / plan.fluid_steps)),
      start_(std::chrono::steady_clock::now()),
      last_progress_(start_) {
  const double keep =
      (static_cast<double>(first) - 0.5) * plan.interval();  // lines before this time
  intervals_done_ = first;
  if (scene.coupling) probes_.emplace(folder, keep);
  if (!scene.output.points.empty())
    points_.emplace(folder + "/points.csv", "time,x,y,pressure,ux,uy", keep);
  if (!obstacle_discs(scene, plan).empty()) obstacles_.emplace(scene, plan, folder, keep);
  if (scene.steady_below > 0.0) steady_.emplace(scene, plan, guard_every_ * plan.fluid_steps);
  if (scene.output.fields_every > 0.0) fields_.emplace(folder, plan.units, keep);
}

bool Observers::draws_at(std::int64_t interval) const {
  return fields_ &&
         static_cast<double>(interval) * plan_.interval() >= next_field_ - 1e-9 * plan_.interval();
}

std::int64_t Observers::next_look(std::int64_t interval) const {
  if (obstacles_) return interval;  // their loads are summed in each
  const auto due = [&](double time) {
    return static_cast<std::int64_t>(std::ceil(time / plan_.interval() - 1e-9));
  };
  std::int64_t next = (interval + guard_every_ - 1) / guard_every_ * guard_every_;
  if (points_) next = std::min(next, due(next_probe_));
  if (fields_) next = std::min(next, due(next_field_));
  return std::max(interval, next);
}

void Observers::after_interval(std::int64_t interval, Fluid& fluid, const Particles* particles) {
  const double time = static_cast<double>(interval) * plan_.interval();
  intervals_done_ = interval + 1;
  if (interval % guard_every_ == 0) {
    guard(interval, fluid, particles);
    if (interval == 0) first_mass_excess_ = mass_excess_;
  }
  if (time >= next_probe_ - 1e-9 * plan_.interval()) {
    write_probes(time, fluid, particles, false);
    while (next_probe_ <= time)
      next_probe_ += std::max(scene_.output.probe_every, plan_.interval());
  }
  if (draws_at(interval)) {
    write_fields(time, fluid, particles);
    while (next_field_ <= time) next_field_ += scene_.output.fields_every;
  }
  if (seconds_since(last_progress_) > kProgressSeconds || intervals_done_ == plan_.intervals)
    report_progress(interval, particles);
}

void Observers::at_end(std::int64_t interval, Fluid& fluid, const Particles* particles) {
  const double time = static_cast<double>(interval) * plan_.interval();
  guard(interval, fluid, particles);
  write_probes(time, fluid, particles, true);
  if (fields_) write_fields(time, fluid, particles);
}

std::vector<double> Observers::state() const {
  std::vector<double> s{next_probe_, next_field_, max_speed_, first_mass_excess_, mass_excess_};
  if (obstacles_) {
    const std::vector<double> loads = obstacles_->state();
    s.insert(s.end(), loads.begin(), loads.end());
  }
  return s;
}

void Observers::restore(const std::vector<double>& s) {
  next_probe_ = s.at(0);
  next_field_ = s.at(1);
  max_speed_ = s.at(2);
  first_mass_excess_ = s.at(3);
  mass_excess_ = s.at(4);
  if (obstacles_) obstacles_->restore(std::span(s).subspan(5));
}

void Observers::write_probes(double time, const Fluid& fluid, const Particles* particles,
                             bool last) {
  if (probes_ && particles)
    probes_->write(time, particles->states(),
                   last ? std::span<const protocol::Load>{} : particles->last_loads());
  if (points_) {
    for (const Vec2& x : scene_.output.points) {
      const auto c = fluid.at(plan_.units.to_lattice_position(x));
      points_->row({time, x.x(), x.y(), (c.rho - 1.0) * plan_.units.pressure(),
                    c.u.x() * plan_.units.velocity(), c.u.y() * plan_.units.velocity()});
    }
    points_->flush();
  }
  if (obstacles_) obstacles_->write(time);
}

void Observers::guard(std::int64_t interval, Fluid& fluid, const Particles* particles) {
  const auto e = fluid.extremes();
  const Vec2 place = plan_.units.origin + plan_.units.dx * Vec2(e.x + 0.5, e.y + 0.5);
  if (!e.finite)
    throw NumericsError(fmt::format(
        "interval {}: the fluid is not finite at ({:.6g}, {:.6g}) m; the step was too long or the "
        "cell too coarse for this flow (Re_h = {:.3g})",
        interval, place.x(), place.y(), plan_.reynolds_cell));
  const double particle = particles ? particles->max_speed() / plan_.units.velocity() : 0.0;
  last_speed_ = e.max_speed;
  max_speed_ = std::max(max_speed_, e.max_speed);
  mass_excess_ = e.mass_excess;
  for (const auto& patch : fluid.patches()) mass_excess_ -= patch->mass_in();
  if (steady_) steady_->look(fluid);
  if (std::max(e.max_speed, particle) <= kStopSpeed) return;
  const bool by_fluid = e.max_speed > particle;
  const double speed = std::max(e.max_speed, particle);
  throw NumericsError(fmt::format(
      "interval {}: {} {}moves at {:.4g} m/s = {:.3g} C, above {}; raise fluid.velocity_scale "
      "(now {} m/s)",
      interval, by_fluid ? "the fluid" : "a particle",
      by_fluid ? fmt::format("at ({:.6g}, {:.6g}) m ", place.x(), place.y()) : "",
      speed * plan_.units.velocity(), speed, kStopSpeed, scene_.fluid.velocity_scale));
}

/// Lines between the centres of bonded particles; across a periodic side there is none.
void Observers::add_bonds(const Particles& particles, FieldFrame& frame) const {
  std::unordered_map<std::int64_t, const protocol::State*> by_id;
  for (const auto& p : particles.states()) by_id.emplace(p.state.id, &p.state);
  const Vec2 half = 0.5 * scene_.box.size;
  for (const protocol::Bond& bond : particles.bonds()->list) {
    const auto a = by_id.find(bond.first), b = by_id.find(bond.second);
    if (a == by_id.end() || b == by_id.end()) continue;  // one has left the box
    const auto &x = a->second->x, &y = b->second->x;
    if (std::abs(x[0] - y[0]) > half.x() || std::abs(x[1] - y[1]) > half.y()) continue;
    frame.bond_ends.insert(frame.bond_ends.end(), {x[0], x[1], y[0], y[1]});
    frame.bond_state.push_back(static_cast<double>(bond.state));
  }
}

void Observers::write_fields(double time, Fluid& fluid, const Particles* particles) {
  const int nx = plan_.domain.nx, ny = plan_.domain.ny;
  FieldFrame frame{time, nx, ny, {}, {}, {}, {}, {}, {}};
  std::vector<double> rho(nx), ux(nx), uy(nx);
  for (int y = 0; y < ny; ++y) {
    fluid.row(y, rho, ux, uy);
    for (int x = 0; x < nx; ++x) {
      frame.pressure.push_back(static_cast<float>((rho[x] - 1.0) * plan_.units.pressure()));
      frame.velocity.push_back(static_cast<float>(ux[x] * plan_.units.velocity()));
      frame.velocity.push_back(static_cast<float>(uy[x] * plan_.units.velocity()));
      frame.velocity.push_back(0.0F);
      if (fluid.has_solids())
        frame.solid_fraction.push_back(static_cast<float>(fluid.solid_fraction(x, y)));
    }
  }
  if (particles)
    for (const auto& [s, shape] : particles->states())
      frame.particles.insert(frame.particles.end(),
                             {static_cast<double>(s.id), s.x[0], s.x[1], shape.radius, s.v[0],
                              s.v[1], s.omega[2], static_cast<double>(shape.type)});
  if (particles && particles->bonds()) add_bonds(*particles, frame);
  fields_->write(frame);
}

void Observers::report_progress(std::int64_t interval, const Particles* particles) {
  last_progress_ = std::chrono::steady_clock::now();
  const double wall = seconds_since(start_);
  const double done = static_cast<double>(intervals_done_) / static_cast<double>(plan_.intervals);
  const double updates =
      static_cast<double>(intervals_done_) * plan_.fluid_steps * plan_.domain.nx * plan_.domain.ny;
  log_.progress(
      done, fmt::format("{:>9} | progress | t = {:.4g} s, {:3.0f} %, {:.0f} million "
                        "updates/s, {} left, Ma {:.3f}, max |u| {:.4g} m/s",
                        interval, static_cast<double>(intervals_done_) * plan_.interval(),
                        100.0 * done, updates / wall * 1e-6, duration_text(wall / done - wall),
                        last_speed_ * std::numbers::sqrt3, last_speed_ * plan_.units.velocity()) +
                (particles && particles->bonds()
                     ? fmt::format(", bonds {} ({} broken)", particles->bonds()->intact,
                                   particles->bonds()->broken)
                     : ""));
}

Summary Observers::summary(double wall_seconds) const {
  Summary s;
  const long cells = static_cast<long>(plan_.domain.nx) * plan_.domain.ny;
  s.cells = cells;
  s.steps = static_cast<long>(intervals_done_) * plan_.fluid_steps;
  s.substeps = plan_.substeps;
  s.physical_seconds = static_cast<double>(intervals_done_) * plan_.interval();
  s.wall_seconds = wall_seconds;
  s.mlups = static_cast<double>(cells) * static_cast<double>(s.steps) / wall_seconds * 1e-6;
  s.ma_max = max_speed_ * std::numbers::sqrt3;
  s.ma_paper = max_speed_;
  s.re = plan_.reynolds;
  s.re_h = plan_.reynolds_cell;
  s.mass_drift = (mass_excess_ - first_mass_excess_) / static_cast<double>(cells);
  s.parameters = {{"cell", plan_.units.dx},
                  {"time_step", plan_.units.dt},
                  {"interval", plan_.interval()},
                  {"tau", plan_.kernel.parameters.tau},
                  {"density", scene_.fluid.density},
                  {"kinematic_viscosity", scene_.fluid.viscosity},
                  {"gravity_x", scene_.fluid.gravity.x()},
                  {"gravity_y", scene_.fluid.gravity.y()},
                  {"depth", scene_.box.depth},
                  {"box_x", scene_.box.size.x()},
                  {"box_y", scene_.box.size.y()},
                  {"velocity_scale", scene_.fluid.velocity_scale}};
  if (scene_.particles) {
    s.parameters["diameter"] = scene_.particles->diameter.hi;
    s.parameters["particle_density"] = scene_.particles->density.hi;
    s.parameters["cells_per_diameter"] = plan_.cells_per_diameter;
  }
  return s;
}

}  // namespace lbm
