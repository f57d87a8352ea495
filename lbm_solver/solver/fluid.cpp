// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/fluid.h"

#include <stdexcept>

#include "lbm_solver/base/contracts.h"
#include "lbm_solver/base/simd.h"
#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/immersed/moving_shape.h"
#include "lbm_solver/immersed/resistance.h"

namespace lbm {
Fluid::Fluid(const Domain& domain, const KernelChoice& choice)
    : Fluid(Decomposition(domain), choice) {}

Fluid::Fluid(const Decomposition& ranks, const KernelChoice& choice)
    : ranks_(std::make_shared<Decomposition>(ranks)),
      f_(lbm::lattice(choice.lattice), cells().size, choice.precision),
      stream_(cells().faces),
      choice_(choice),
      kernel_(make_kernel(choice)),
      halo_(ranks.alone() ? nullptr : std::make_unique<HaloExchange>(*ranks_, f_)),
      cover_(choice.solid_term == SolidTerm::None
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
  if (choice.eddies == EddyModel::Wale && choice.parameters.smagorinsky > 0.0) {
    wale_ = std::make_unique<Wale>(*ranks_);
    medium_.eddies = &wale_->field();
  }
  if (lattice().D != domain().dimension())
    throw std::invalid_argument(name_of(lattice().id) + " for a box of " +
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

void Fluid::hold_flow(const FlowControl& control) {
  BPLBM_EXPECT(choice_.force);
  flow_ = control;
}

void Fluid::hold_flow(const PressureControl& control) {
  BPLBM_EXPECT(dynamic_cast<PressurePatch*>(patches_.at(control.patch()).get()));
  pressure_ = control;
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
  if (flow_) {
    CollisionParameters& p = now.parameters;
    (flow_->axis() == 0 ? p.force_x : flow_->axis() == 1 ? p.force_y : p.force_z) += flow_->force();
  }
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
}

void Fluid::add(const MeshSolid& solid, PoseInTime pose, std::optional<double> drum, bool steady) {
  BPLBM_EXPECT(cover_ != nullptr);
  cover_->add(std::make_unique<MovingShape>(
      solid, radius_shift(choice_.solid_term, domain().dimension()), drum, steady));
  Body& body = fixed_.emplace_back();
  body.id = static_cast<std::int64_t>(fixed_.size());
  movers_.push_back({fixed_.size() - 1, std::move(pose)});
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
  return fixed_two_steps_.mean(fixed_, cover_->fixed_loads(), domain(), cells());
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
    kernel_->sweep(f_, stream, cover_.get(), eddies(), low);
    kernel_->sweep(f_, stream, cover_.get(), eddies(), high);
    ++begin;
    --end;
#pragma omp barrier
#pragma omp master
    halo_->begin(first, f_, stream);
  }
  kernel_->sweep(f_, stream, cover_.get(), eddies(), inner);
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
  while (steps > 0) {
    const bool changes = force_in_time_.changes_after(steps_);
    std::int64_t made = changes ? 1 : steps;
    if (flow_) made = adjust_flow(made);
    if (pressure_) made = adjust_pressure(made);
    if (wale_) made = adjust_eddies(made);
    make_steps_under_force(made, after_each);
    if (changes) set_body_force();
    steps -= made;
  }
}

/// Finds the force that holds the flow, where it is time. @return how many of the coming steps it
/// stays for
std::int64_t Fluid::adjust_flow(std::int64_t steps) {
  if (flow_->due(steps_)) {
    flow_->adjust(steps_, mean_velocity(*this, flow_->axis()));
    set_body_force();
  }
  return std::min(steps, flow_->until_next(steps_));
}

/// Finds the pressure that holds the flow through an opening, where it is time. @return likewise
std::int64_t Fluid::adjust_pressure(std::int64_t steps) {
  if (pressure_->due(steps_)) {
    Patch& patch = *patches_[pressure_->patch()];
    double mass_in = patch.mass_in();
    ranks_->sum({&mass_in, 1});
    pressure_->adjust(steps_, mass_in);
    static_cast<PressurePatch&>(patch).hold(pressure_->drho());
  }
  return std::min(steps, pressure_->until_next(steps_));
}

/// Finds the eddy viscosity's factors, where it is time. @return likewise
std::int64_t Fluid::adjust_eddies(std::int64_t steps) {
  if (wale_->due(steps_)) wale_->update(*this);
  return std::min(steps, wale_->until_next(steps_));
}

/// A step is three operators, each called by every thread of one parallel region.
void Fluid::make_steps_under_force(std::int64_t steps, const AfterStep& after_each) {
  const bool links = scheme_ || !patches_.empty() || after_each;
#pragma omp parallel
  {
    flush_denormals();
    EsotericPull stream = stream_;  // every thread turns its own, so that a sweep has one barrier
    for (std::int64_t s = 1; s <= steps; ++s) {
      prepare_bodies(stream);
      stream_and_collide(stream, links || s < steps);
      if (links) act_on_links(stream, steps_ + s, after_each);
    }
  }
  if (!after_each && steps % 2 != 0) stream_.advance();
  steps_ += steps;
}

/// Cell lists: what a body scheme does before the sweep.
void Fluid::prepare_bodies(const EsotericPull& stream) {
  if (!scheme_) return;
#pragma omp single
  scheme_->before_sweep(bodies_, f_, stream);
}

/// Bulk: fluid and covered cells in one sweep, and the exchange with neighbouring ranks. A second
/// backend would stand behind `kernel_`, a second level of refinement beside `halo_`.
/// @param barrier  whether to leave with one: the end of a parallel region is one
void Fluid::stream_and_collide(EsotericPull& stream, bool barrier) {
  if (halo_)
    sweep_and_exchange(stream);
  else
    kernel_->sweep(f_, stream, cover_.get(), eddies(), Rows::all(f_));
  stream.advance();
  if (!halo_ && barrier) {
#pragma omp barrier
  }
}

/// Link lists: the body scheme's, then each boundary condition in the order of its adding; last,
/// whoever observes the step.
void Fluid::act_on_links(const EsotericPull& stream, std::int64_t step,
                         const AfterStep& after_each) {
#pragma omp single
  {
    std::function<double(const Cell3&)> solids;
    if (cover_)
      solids = [this](const Cell3& c) { return cover_->solid_fraction(c[0], c[1], c[2]); };
    if (scheme_) scheme_->after_sweep(f_, stream);
    for (const auto& patch : patches_) patch->apply({f_, stream, step, solids});
    if (after_each) {
      stream_.set_odd(stream.odd());
      after_each();
    }
  }
}

double Fluid::mass_in() const {
  double sum = 0.0;
  for (const auto& patch : patches_) sum += patch->mass_in();
  ranks_->sum({&sum, 1});
  return sum;
}

std::map<std::string, double> Fluid::bytes() const {
  double parts[] = {static_cast<double>(f_.bytes()),
                    cover_ ? static_cast<double>(cover_->bytes()) : 0.0};
  ranks_->sum(parts);
  std::map<std::string, double> bytes{{"populations", parts[0]}};
  if (cover_) bytes["solids"] = parts[1];
  return bytes;
}

}  // namespace lbm
