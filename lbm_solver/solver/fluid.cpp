// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/fluid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "lbm_solver/base/contracts.h"
#include "lbm_solver/base/simd.h"
#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/immersed/moving_shape.h"
#include "lbm_solver/immersed/resistance.h"
#include "lbm_solver/immersed/solid_fraction.h"

namespace lbm {
namespace {

constexpr double kWallLag = 0.5;  // of cells that reflect all that arrives: the mean of two steps

}  // namespace

Fluid::Fluid(const Domain& domain, const KernelChoice& choice)
    : Fluid(Decomposition(domain), choice) {}

Fluid::Fluid(const Decomposition& ranks, const KernelChoice& choice)
    : ranks_(std::make_shared<Decomposition>(ranks)),
      f_(lbm::lattice(choice.lattice), cells().size, choice.precision),
      stream_(cells().faces),
      choice_(choice),
      kernel_(make_kernel(choice)),
      halo_(ranks.alone() ? nullptr : std::make_unique<HaloExchange>(*ranks_, f_)),
      cover_(choice.solid_term == "none"
                 ? nullptr
                 : std::make_unique<CoverMap>(
                       domain(), cells(), radius_shift(choice.solid_term, domain().dimension()))),
      medium_{choice.parameters, choice.local_viscosity(), cover_.get(),
              SolidShare(choice.solid_term, choice.weight, choice.parameters)},
      two_steps_(load_lag(choice.solid_term, choice.parameters.tau)),
      fixed_two_steps_(two_steps_) {
  if (!choice.force) {
    CollisionParameters& p = choice_.parameters;
    p.force_x = p.force_y = p.force_z = 0.0;
    medium_.parameters = p;
  }
  if (lattice().D != domain().dimension())
    throw std::invalid_argument(std::string(lattice().name) + " for a box of " +
                                std::to_string(domain().dimension()) + " dimensions");
}

void Fluid::set_equilibrium(const Cell3& cell, double rho, const Vec3& u) {
  // the step adds the other half of a body force
  lbm::set_equilibrium(f_, stream_, cell, rho - 1.0, u - 0.5 * body_force() / rho);
}

Vec3 Fluid::body_force() const {
  const CollisionParameters& p = medium_.parameters;
  return {p.force_x, p.force_y, p.force_z};
}

void Fluid::vary_body_force(const InTime& in_time) {
  force_in_time_ = in_time;
  set_body_force();
}

void Fluid::set_body_force(const Vec3& force) {
  BPLBM_EXPECT(choice_.force);
  CollisionParameters& p = choice_.parameters;
  p.force_x = force.x();
  p.force_y = force.y();
  p.force_z = force.z();
  set_body_force();
}

/// That of the coming step, which is collided at the time of the present one. A ramp counts the
/// step that ends. A kernel knows one force: while it changes, every step has a kernel of its own.
void Fluid::set_body_force() {
  const double part = force_in_time_.ramp(steps_ + 1) * force_in_time_.wave(steps_);
  KernelChoice now = choice_;
  for (double CollisionParameters::*component :
       {&CollisionParameters::force_x, &CollisionParameters::force_y,
        &CollisionParameters::force_z})
    now.parameters.*component *= part;
  kernel_ = make_kernel(now);
  medium_.parameters = now.parameters;
  if (scheme_) scheme_->set_body_force(body_force());
}

void Fluid::add(const Geometry& geometry) {
  BPLBM_EXPECT(cover_ != nullptr);
  cover_->add(geometry);
  Body& body = fixed_.emplace_back();
  body.id = static_cast<std::int64_t>(fixed_.size());
  body.centre = geometry.centre();
  fixed_lags_.push_back(load_lag(choice_.solid_term, choice_.parameters.tau));
}

void Fluid::add(const MeshSolid& solid, PoseInTime pose, bool stays) {
  BPLBM_EXPECT(cover_ != nullptr);
  cover_->add(std::make_unique<MovingShape>(
      solid, radius_shift(choice_.solid_term, domain().dimension()), stays));
  Body& body = fixed_.emplace_back();
  body.id = static_cast<std::int64_t>(fixed_.size());
  movers_.push_back({fixed_.size() - 1, std::move(pose)});
  fixed_lags_.push_back(stays ? kWallLag : load_lag(choice_.solid_term, choice_.parameters.tau));
  moved_to_ = -1;
}

void Fluid::move_shapes() {
  if (movers_.empty() || moved_to_ == steps_) return;
  remember_loads();
  std::vector<Pose> poses;
  for (const Mover& mover : movers_) {
    poses.push_back(mover.pose(steps_));
    fixed_[mover.fixed].centre = poses.back().centre();
  }
  cover_->move(poses);
  moved_to_ = steps_;
}

void Fluid::place(std::span<const Body> bodies) {
  BPLBM_EXPECT(has_solids());
  remember_loads();
  move_shapes();
  bodies_.assign(bodies.begin(), bodies.end());
  if (!scheme_) cover_->update(bodies);
}

/// Before the map forgets the loads of the last step.
void Fluid::remember_loads() {
  if (!two_steps_.on() || scheme_ || !loads_are_new_) return;
  two_steps_.remember(bodies_, cover_->loads());
  if (!fixed_.empty()) fixed_two_steps_.remember(fixed_, cover_->fixed_loads());
  loads_are_new_ = false;
}

std::vector<BodyLoad> Fluid::loads() const {
  if (bodies_.empty()) return {};
  if (!two_steps_.on() || scheme_) return momentary_loads();
  return two_steps_.mean(bodies_, cover_->loads(), domain(), cells());
}

std::vector<BodyLoad> Fluid::fixed_loads() const {
  if (fixed_.empty()) return {};
  if (!two_steps_.on()) return cover_->fixed_loads();
  return fixed_two_steps_.mean(fixed_, cover_->fixed_loads(), domain(), cells(), fixed_lags_);
}

namespace {

/// From a body's centre, or that of its nearest image, to the centre of a cell.
Vec3 arm_to(const Body& body, const Domain& domain, int x, int y, int z) {
  const Vec3 centre(x + 0.5, y + 0.5, domain.dimension() == 3 ? z + 0.5 : 0.0);
  return domain.nearest_image(centre - body.centre);
}

/// Part of the cell at the end of the arm that the body covers.
double fraction_at(const Body& body, const Domain& domain, const Vec3& arm) {
  const double fraction = domain.dimension() == 3
                              ? sphere_fraction(arm.x(), arm.y(), arm.z(), body.radius)
                              : disc_fraction(arm.x(), arm.y(), body.radius);
  return body.hollow ? 1.0 - fraction : fraction;
}

}  // namespace

double Fluid::solid_fraction(int x, int y, int z) const {
  double sum = cover_ ? cover_->solid_fraction(x, y, z) : 0.0;
  if (!scheme_) return sum;
  for (const Body& body : bodies_)
    sum += fraction_at(body, domain(), arm_to(body, domain(), x, y, z));
  return std::min(1.0, sum);
}

/// One step's sweep where neighbours are other ranks; called by every thread of a parallel region.
/// The rows at the faces of the first axis go first, so that their populations travel while the
/// rest is swept. Leaves with a barrier.
void Fluid::sweep_and_exchange(EsotericPull& stream) {
  const int first = halo_->axes().front();
  Rows inner = Rows::all(f_);
  if (first > 0) {
    int& begin = first == 2 ? inner.z_begin : inner.y_begin;
    int& end = first == 2 ? inner.z_end : inner.y_end;
    Rows low = inner, high = inner;
    (first == 2 ? low.z_end : low.y_end) = begin + 1;
    (first == 2 ? high.z_begin : high.y_begin) = end - 1;
    kernel_->sweep(f_, stream, cover_.get(), low);
    kernel_->sweep(f_, stream, cover_.get(), high);
    ++begin;
    --end;
#pragma omp barrier
#pragma omp master
    halo_->begin(first, f_, stream);
  }
  kernel_->sweep(f_, stream, cover_.get(), inner);
#pragma omp barrier
#pragma omp master
  {
    for (const int axis : halo_->axes()) {
      if (axis != first || first == 0) halo_->begin(axis, f_, stream);
      halo_->finish(axis, f_, stream);
    }
  }
#pragma omp barrier
}

void Fluid::advance(std::int64_t steps, const AfterStep& after_each) {
  if (bodies_.empty() && fixed_.empty()) return make_steps(steps, after_each);
  if (after_each) {  // all threads sum the loads of bodies, between two regions
    for (; steps > 0; --steps) {
      advance(1);
      after_each();
    }
    return;
  }
  if (!movers_.empty()) {
    for (; steps > 1; --steps) advance(1);
    move_shapes();
  }
  if (!two_steps_.on()) return make_steps(steps, {});
  remember_loads();
  if (steps > 1) {  // the load of a step needs that of the step before
    make_steps(steps - 1, {});
    loads_are_new_ = true;
    remember_loads();
  }
  make_steps(1, {});
  loads_are_new_ = true;
}

void Fluid::make_steps(std::int64_t steps, const AfterStep& after_each) {
  for (; steps > 0 && force_in_time_.changes_after(steps_); --steps) {
    make_steps_under_force(1, after_each);
    set_body_force();
  }
  if (steps > 0) make_steps_under_force(steps, after_each);
}

void Fluid::make_steps_under_force(std::int64_t steps, const AfterStep& after_each) {
  const bool passes = scheme_ || !patches_.empty() || after_each;
  std::function<double(const Cell3&)> solids;
  if (cover_) solids = [this](const Cell3& c) { return cover_->solid_fraction(c[0], c[1], c[2]); };
#pragma omp parallel
  {
    flush_denormals();
    EsotericPull stream = stream_;  // every thread turns its own, so that a sweep has one barrier
    for (std::int64_t s = 1; s <= steps; ++s) {
      if (scheme_) {
#pragma omp single
        scheme_->before_sweep(bodies_, f_, stream);
      }
      if (halo_)
        sweep_and_exchange(stream);
      else
        kernel_->sweep(f_, stream, cover_.get(), Rows::all(f_));
      stream.advance();
      if (!passes && s == steps) break;  // the end of the region is the barrier
      if (!halo_) {
#pragma omp barrier
      }
      if (!passes) continue;
#pragma omp single
      {
        if (scheme_) scheme_->after_sweep(f_, stream);
        for (const auto& patch : patches_) patch->apply({f_, stream, steps_ + s, solids});
        if (after_each) {
          stream_.set_odd(stream.odd());
          after_each();
        }
      }
    }
  }
  if (!after_each && steps % 2 != 0) stream_.advance();
  steps_ += steps;
}

double Fluid::mass_in() const {
  double sum = 0.0;
  for (const auto& patch : patches_) sum += patch->mass_in();
  ranks_->sum({&sum, 1});
  return sum;
}

Fluid::Cell Fluid::cell(int x, int y, int z) const {
  const CellMoments m = cell_moments(f_, stream_, x, y, z);
  return {m.drho + 1.0, (m.j + 0.5 * body_force()) / (m.drho + 1.0)};
}

Vec3 Fluid::arrived_momentum(int x, int y, int z) const {
  return cell_moments(f_, stream_, x, y, z).j;
}

Fluid::Cell Fluid::at(const Vec3& place) {
  int low[3];
  double part[3];
  for (int a = 0; a < 3; ++a) {
    const int n = domain().cells()[a];
    const double inside = std::clamp(place[a] - 0.5, 0.0, static_cast<double>(n - 1));
    low[a] = std::min(static_cast<int>(inside), std::max(0, n - 2));
    part[a] = n > 1 ? inside - low[a] : 0.0;
  }
  const auto nx = static_cast<std::size_t>(cells().size[0]);
  std::vector<double> rho(nx), solid(nx), u[3];
  for (auto& component : u) component.assign(nx, 0.0);
  double sum[5] = {0.0, 0.0, 0.0, 0.0, 0.0};  // rho, velocity, weight of cells without fluid
  for (int corner = 0; corner < (1 << domain().dimension()); ++corner) {
    Cell3 at;
    double weight = 1.0;
    for (int a = 0; a < 3; ++a) {
      const int up = corner >> a & 1;
      at[a] = low[a] + up;
      weight *= up ? part[a] : 1.0 - part[a];
    }
    if (!cells().holds(at)) continue;
    const auto& b = cells().begin;
    moments(at[1] - b[1], at[2] - b[2], rho, {u[0], u[1], u[2]}, solid);
    const int x = at[0] - b[0];
    (solid[x] < 1.0 ? sum[0] : sum[4]) += weight * (solid[x] < 1.0 ? rho[x] : 1.0);
    for (int a = 0; a < 3; ++a) sum[1 + a] += weight * u[a][x];
  }
  ranks_->sum(sum);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const double fluid = 1.0 - sum[4];
  const double mean = sum[4] == 0.0 ? sum[0] : fluid > 1e-12 ? sum[0] / fluid : none;
  return {mean, {sum[1], sum[2], sum[3]}};
}

/// Where a body covers cells of a row whole, they move as it does.
void Fluid::cover_by(const Body& body, int y, int z, const RowVelocity& u,
                     std::span<double> solid) {
  const Vec3 row = arm_to(body, domain(), 0, y, z);
  if (!body.hollow && std::hypot(row.y(), row.z()) > body.radius) return;
  for (int x = 0; x < cells().size[0]; ++x) {
    const Vec3 arm = arm_to(body, domain(), x, y, z);
    if (fraction_at(body, domain(), arm) < kWhole) continue;
    const Vec3 velocity = body.velocity_at(arm);
    for (int a = 0; a < domain().dimension(); ++a) u[a][x] = velocity[a];
    solid[x] = 1.0;
  }
}

/// Density of what has arrived in a row, its velocity as it is shown, and the solid's share in it.
void Fluid::moments(int y, int z, std::span<double> rho, const RowVelocity& u,
                    std::span<double> solid) {
  row_moments(f_, stream_, y, z, medium_, rho, u, solid);
  if (!scheme_) return;
  for (const Body& body : bodies_) cover_by(body, y, z, u, solid);
}

void Fluid::row(int y, int z, std::span<double> rho, const RowVelocity& u) {
  std::vector<double> solid(rho.size());
  moments(y, z, rho, u, solid);
  for (std::size_t x = 0; x < rho.size(); ++x)
    if (solid[x] >= 1.0) rho[x] = std::numeric_limits<double>::quiet_NaN();
}

Fluid::Extremes Fluid::extremes() {
  const Cell3 n = cells().size, &begin = cells().begin;
  double largest = 0.0, excess = 0.0;
  Cell3 fastest = begin, broken{0, 0, 0};
  bool finite = true;
  std::vector<double> rho(n[0]), solid(n[0]), u[3];
  for (auto& component : u) component.assign(n[0], 0.0);
  for (int z = 0; z < n[2] && finite; ++z)
    for (int y = 0; y < n[1] && finite; ++y) {
      moments(y, z, rho, {u[0], u[1], u[2]}, solid);
      for (int x = 0; x < n[0] && finite; ++x) {
        const double speed2 = u[0][x] * u[0][x] + u[1][x] * u[1][x] + u[2][x] * u[2][x];
        excess += rho[x] - 1.0;
        const Cell3 here{x + begin[0], y + begin[1], z + begin[2]};
        if (!std::isfinite(rho[x] + speed2)) {
          finite = false;
          broken = here;
        } else if (speed2 > largest && solid[x] < 1.0) {
          largest = speed2;
          fastest = here;
        }
      }
    }
  // One line a rank: every rank draws the same conclusion from all of them.
  const Cell3& cell = finite ? fastest : broken;
  std::vector<double> lines = ranks_->collect({finite ? 1.0 : 0.0, std::sqrt(largest), excess,
                                               1.0 * cell[0], 1.0 * cell[1], 1.0 * cell[2]});
  ranks_->broadcast(lines);
  Extremes e;
  for (std::size_t i = 0; i < lines.size(); i += 6) {
    const double* line = &lines[i];
    const bool sound = line[0] == 1.0;
    e.mass_excess += line[2];
    if (!e.finite || (sound && line[1] <= e.max_speed)) continue;
    e.finite = sound;
    e.max_speed = line[1];
    e.cell = {static_cast<int>(line[3]), static_cast<int>(line[4]), static_cast<int>(line[5])};
  }
  return e;
}

std::map<std::string, double> Fluid::bytes() const {
  double parts[] = {static_cast<double>(f_.bytes()),
                    cover_ ? static_cast<double>(cover_->bytes()) : 0.0};
  ranks_->sum(parts);
  std::map<std::string, double> bytes{{"populations", parts[0]}};
  if (cover_) bytes["solids"] = parts[1];
  return bytes;
}

namespace {

/// Calls f(number, cell) for every cell of a block, in the order of Decomposition::gather.
template <class F>
void each_cell(const Cell3& n, F&& f) {
  std::size_t number = 0;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x) f(number++, x, y, z);
}

}  // namespace

Record Fluid::save_boundary(std::size_t number) const {
  Patch& patch = *patches_[number];
  std::vector<double> lines;
  for (std::size_t k = 0; k < patch.memory().size(); ++k)
    lines.insert(lines.end(), {static_cast<double>(patch.links()[k].number), patch.memory()[k]});
  lines = ranks_->collect(lines);
  std::vector<double> links(lines.size() / 2);
  for (std::size_t k = 0; k < lines.size(); k += 2)
    links[static_cast<std::size_t>(lines[k])] = lines[k + 1];
  Record record;
  record.set("links", std::move(links));
  record.set("mass_in", ranks_->collect_parts({patch.mass_in()}));
  return record;
}

void Fluid::load_boundary(std::size_t number, const Record& record) {
  const auto& links = record.get<std::vector<double>>("links");
  std::vector<double>& memory = patches_[number]->memory();
  for (std::size_t k = 0; k < memory.size(); ++k) {
    const auto link = static_cast<std::size_t>(patches_[number]->links()[k].number);
    if (link >= links.size()) throw std::invalid_argument("'links' is of another size");
    memory[k] = links[link];
  }
  patches_[number]->restore_mass(
      ranks_->own_part(record.get<std::vector<double>>("mass_in"), 1)[0]);
}

Record Fluid::save() const {
  Record record;
  const auto q_count = static_cast<std::size_t>(lattice().Q);
  const Cell3& n = cells().size;
  std::vector<double> mine(q_count * n[0] * n[1] * n[2]);
  each_cell(n, [&](std::size_t number, int x, int y, int z) {
    for (int q = 0; q < lattice().Q; ++q) mine[number * q_count + q] = arriving(q, x, y, z);
  });
  record.set("populations", ranks_->gather(std::move(mine), lattice().Q));
  record.set("steps", steps_);
  record.set("odd", std::int64_t{stream_.odd()});
  for (std::size_t i = 0; i < patches_.size(); ++i)
    record.set("boundary" + std::to_string(i + 1), save_boundary(i));
  if (scheme_) record.set("scheme", scheme_->save());
  if (two_steps_.on()) {
    TwoStepLoads last = two_steps_;
    if (loads_are_new_) last.remember(bodies_, cover_->loads());
    record.set("loads", last.save(*ranks_));
    if (!fixed_.empty()) {
      TwoStepLoads fixed = fixed_two_steps_;
      if (loads_are_new_) fixed.remember(fixed_, cover_->fixed_loads());
      record.set("fixed_loads", fixed.save(*ranks_));
    }
  }
  return record;
}

void Fluid::load(const Record& record) {
  for (std::size_t i = 0; i < patches_.size(); ++i)
    load_boundary(i, record.part("boundary" + std::to_string(i + 1)));
  if (scheme_) scheme_->load(record.part("scheme"));
  if (two_steps_.on()) {
    two_steps_.load(record.part("loads"));
    if (!fixed_.empty()) fixed_two_steps_.load(record.part("fixed_loads"));
    loads_are_new_ = false;
  }
  const Cell3 n = cells().size, all = domain().cells();
  const auto q_count = static_cast<std::size_t>(lattice().Q);
  std::vector<double> populations;
  if (ranks_->rank() == 0)
    populations = record.list<double>("populations", q_count * all[0] * all[1] * all[2]);
  populations = ranks_->scatter(std::move(populations), lattice().Q);
  steps_ = record.integer("steps");
  move_shapes();
  stream_.set_odd(record.integer("odd") != 0);
  if (force_in_time_.changes_after(0)) set_body_force();
  each_cell(n, [&](std::size_t number, int x, int y, int z) {
    for (int q = 0; q < lattice().Q; ++q) arriving(q, x, y, z) = populations[number * q_count + q];
  });
}

}  // namespace lbm
