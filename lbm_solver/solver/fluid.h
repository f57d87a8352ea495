// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lbm_solver/base/record.h"
#include "lbm_solver/boundary/patch.h"
#include "lbm_solver/field/halo_exchange.h"
#include "lbm_solver/immersed/body_scheme.h"
#include "lbm_solver/immersed/two_step_loads.h"
#include "lbm_solver/solver/flow_control.h"
#include "lbm_solver/solver/kernel.h"
#include "lbm_solver/solver/pressure_control.h"
#include "lbm_solver/solver/row_moments.h"
#include "lbm_solver/solver/wale.h"

namespace lbm {

struct MeshSolid;

/// The fluid: a lattice, what happens at its sides, and the solids in it. Everything in lattice
/// units. Where several ranks share the box, each holds its block of cells: cells are counted from
/// the block's first, places of bodies and points from the box's. Functions that say so are
/// collective: every rank calls them at the same place.
class Fluid {
 public:
  /// Starts at rest with density 1.
  /// @throws std::invalid_argument where the lattice has not the box's dimension
  Fluid(const Domain& domain, const KernelChoice& choice);
  Fluid(const Decomposition& ranks, const KernelChoice& choice);

  /// The whole box.
  const Domain& domain() const { return ranks_->domain(); }
  const Decomposition& ranks() const { return *ranks_; }
  const Lattice& lattice() const { return f_.lattice(); }
  /// This rank's cells.
  const Block& cells() const { return ranks_->cells(); }
  bool has_solids() const { return cover_ || scheme_; }
  const CoverMap* cover() const { return cover_.get(); }

  /// Sets a cell to the equilibrium of a density and a velocity.
  void set_equilibrium(const Cell3& cell, double rho, const Vec3& u);
  void set_equilibrium(int x, int y, double rho, const Vec3& u) {
    set_equilibrium({x, y, 0}, rho, u);
  }

  /// Adds a boundary on a part of a side; patches act in the order in which they were added.
  void add(std::unique_ptr<Patch> patch) { patches_.push_back(std::move(patch)); }
  const std::vector<std::unique_ptr<Patch>>& patches() const { return patches_; }
  /// Mass that has entered through all patches on all ranks since the start. Collective.
  double mass_in() const;
  /// Links of an opening in this rank's cells, for a patch.
  std::vector<Link> links(const Opening& opening) const {
    return side_links(lattice(), domain(), cells(), opening);
  }
  /// Cells [from, to) of the box become a wall at rest. Needs a solid term in the kernel's choice.
  void add_wall(const Cell3& from, const Cell3& to) { cover_->add_wall(from, to); }
  /// A solid of any shape that stays where it is. Needs a solid term in the kernel's choice.
  /// @throws std::invalid_argument  see fill()
  void add(const Geometry& geometry);
  /// A mesh that moves as it is told; before bodies are placed.
  /// @param drum  it is the wall of a drum, whose load is that of the cells nearer to the pivot
  /// @param steady  it moves along itself at one velocity: nothing passes it from eleven cells
  /// on, or a drum, whose cells farther than that stand
  /// @throws std::invalid_argument  see fill()
  void add(const MeshSolid& solid, PoseInTime pose, std::optional<double> drum = {},
           bool steady = false);
  /// Puts the meshes that move where they are at the present step; the next step does so too.
  void move_shapes();

  /// Solids act by a scheme of its own instead of covered cells (which walls keep). One rank only.
  void use(std::unique_ptr<BodyScheme> scheme) {
    scheme_ = std::move(scheme);
    scheme_->set_body_force(body_force());
  }
  /// The body force of the kernel's choice changes in time as `in_time` says.
  void vary_body_force(const InTime& in_time);
  /// A further body force along an axis holds a flow. The kernel's choice must have one.
  void hold_flow(const FlowControl& control);
  /// The pressure of a pressure patch that was added holds a flow through it.
  void hold_flow(const PressureControl& control);
  /// Null where no flow is held in this way.
  const FlowControl* flow_control() const { return flow_ ? &*flow_ : nullptr; }
  const PressureControl* pressure_control() const { return pressure_ ? &*pressure_ : nullptr; }
  /// Null: the eddy viscosity is Smagorinsky's everywhere, or there is none.
  const EddyField* eddies() const { return medium_.eddies; }
  /// Another one from the coming step on. The kernel's choice must have one.
  void set_body_force(const Vec3& force);
  /// On a cell in the coming step.
  Vec3 body_force() const;
  /// Places the solids for the next step. Needs a scheme, or a solid term in the kernel's choice.
  void place(std::span<const Body> bodies);

  /// Called after a step, by one thread while the others wait: it may ask for loads and
  /// populations; it must place nothing, call nothing that is collective, and throw nothing.
  using AfterStep = std::function<void()>;

  /// Advances by one time step, or by some, between which nothing is placed, or asked for but by
  /// `after_each`: in one parallel region, but for bodies whose loads are asked for. Collective.
  void step() { advance(1); }
  void advance(std::int64_t steps, const AfterStep& after_each = {});
  std::int64_t steps() const { return steps_; }

  /// Loads on the placed bodies over the last step, in their order: this rank's cells' part. By
  /// resistance with a part of the step before (load_lag), which takes the ringing out.
  std::vector<BodyLoad> loads() const;
  /// What the bodies took from their cells in the last step alone: what the fluid lost.
  std::vector<BodyLoad> momentary_loads() const {
    return scheme_ ? scheme_->loads() : cover_->loads();
  }
  /// Likewise on the solids that were added, about their centres or pivots, in their order.
  std::vector<BodyLoad> fixed_loads() const;
  /// Part of a cell that solids cover, at most 1.
  double solid_fraction(int x, int y, int z = 0) const;

  struct Cell {
    double rho = 0.0;
    Vec3 u;
  };
  /// Density and velocity of the populations that have arrived at a cell, whatever covers it.
  Cell cell(int x, int y, int z = 0) const;
  /// Momentum of the populations that have arrived at a cell, without any of the body force: its
  /// mean over the box is the flux of a steady flow.
  Vec3 arrived_momentum(int x, int y, int z = 0) const;
  /// What a row shows, at any place of the box: between the centres of the nearest cells (linear
  /// along each axis); the density is that of those with fluid. Collective.
  Cell at(const Vec3& place);

  /// Population f_q - w_q that has arrived at a cell, for tests and cell passes.
  Population arriving(int q, int x, int y, int z = 0) { return stream_.arriving(f_, q, x, y, z); }
  double arriving(int q, int x, int y, int z = 0) const { return stream_.arriving(f_, q, x, y, z); }
  /// The coming step is an odd one; a population lies at one place in all of these, at another in
  /// the even ones.
  bool odd() const { return stream_.odd(); }
  Population arriving_in(bool odd, int q, int x, int y, int z = 0) {
    EsotericPull stream = stream_;
    stream.set_odd(odd);
    return stream.arriving(f_, q, x, y, z);
  }

  struct Extremes {
    double max_speed = 0.0;    ///< of cells with fluid, as a row shows it
    Cell3 cell{0, 0, 0};       ///< of the box: that of max_speed, or the first that is not finite
    bool finite = true;        ///< of all cells
    double mass_excess = 0.0;  ///< Σ (rho - 1) of all cells: solids and fluid exchange mass
  };
  /// Of all ranks. Collective.
  Extremes extremes();

  /// What a row of this rank shows. Covered cells have the velocity (1-B) u + B u_s, with B the
  /// solid's share (SolidShare); under a scheme of its own the solid's velocity where they are
  /// covered whole. Where a cell is covered whole there is no fluid: its density is not a number.
  /// @param rho, u  [nx] each, overwritten
  void row(int y, int z, std::span<double> rho, const RowVelocity& u);

  /// Everything that the coming steps depend on; it knows nothing of the ranks. All but the
  /// populations is complete on rank 0; those are read from the fluid when they are written, so
  /// before its next step. Obstacles and boundaries must be in place again before `load`, which
  /// wants the same record on every rank, with the populations of its cells. Collective.
  /// @throws std::invalid_argument where the record is of another fluid
  Record save() const;
  void load(const Record& record);

  /// Seconds that this rank has waited for its neighbours in its steps.
  double waited() const { return halo_ ? halo_->waited() : 0.0; }
  /// Bytes that its parts take on all ranks: "populations" and, where covered cells are, "solids".
  /// Collective.
  std::map<std::string, double> bytes() const;

 private:
  void prepare_bodies(const EsotericPull& stream);
  void stream_and_collide(EsotericPull& stream, bool barrier);
  void sweep_and_exchange(EsotericPull& stream);
  void act_on_links(const EsotericPull& stream, std::int64_t step, const AfterStep& after_each);
  void make_steps(std::int64_t steps, const AfterStep& after_each);
  void make_steps_under_force(std::int64_t steps, const AfterStep& after_each);
  void set_body_force();
  std::int64_t adjust_flow(std::int64_t steps);
  std::int64_t adjust_pressure(std::int64_t steps);
  std::int64_t adjust_eddies(std::int64_t steps);
  void remember_loads();
  Record save_boundary(std::size_t number) const;
  void load_boundary(std::size_t number, const Record& record);
  void load_populations(const CellValues& populations);
  void moments(int y, int z, std::span<double> rho, const RowVelocity& u, std::span<double> solid);
  void cover_by(const Body& body, int y, int z, const RowVelocity& u, std::span<double> solid);

  std::shared_ptr<const Decomposition> ranks_;
  Populations f_;
  EsotericPull stream_;
  KernelChoice choice_;
  std::unique_ptr<Kernel> kernel_;
  InTime force_in_time_;
  std::optional<FlowControl> flow_;
  std::optional<PressureControl> pressure_;
  std::unique_ptr<Wale> wale_;
  std::unique_ptr<HaloExchange> halo_;
  std::unique_ptr<CoverMap> cover_;
  RowMedium medium_;
  std::unique_ptr<BodyScheme> scheme_;
  std::vector<Body> bodies_;  // as placed
  std::vector<Body> fixed_;   // that were added: their names and centres
  struct Mover {
    std::size_t fixed;  // which of those
    PoseInTime pose;
  };
  std::vector<Mover> movers_;
  std::int64_t moved_to_ = -1;  // step whose poses the map has
  TwoStepLoads two_steps_, fixed_two_steps_;
  bool loads_are_new_ = false;  // those in the map are of a step that two_steps_ does not know
  std::vector<std::unique_ptr<Patch>> patches_;
  std::int64_t steps_ = 0;
};

}  // namespace lbm
