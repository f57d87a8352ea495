// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "lbm_solver/base/choices.h"
#include "lbm_solver/base/record.h"
#include "lbm_solver/field/esoteric_pull.h"
#include "lbm_solver/immersed/body.h"
#include "lbm_solver/immersed/footprint.h"

namespace lbm {

/// A way in which solids act on the fluid that is a pass of its own over cells or links, before or
/// after the sweep. (The immersed moving boundary is none: its covered cells are part of the
/// sweep.) These are the schemes that the field compares with; they are written to be read, not to
/// be fast.
class BodyScheme {
 public:
  virtual ~BodyScheme() = default;

  /// Places the solids for the coming step and prepares the cells for it.
  virtual void before_sweep(std::span<const Body> bodies, Populations& f,
                            const EsotericPull& stream) = 0;
  /// Corrects what arrived. `stream` has advanced.
  virtual void after_sweep(Populations&, const EsotericPull&) {}

  /// Load of each body over the last step, in the order of before_sweep.
  virtual std::vector<BodyLoad> loads() const = 0;

  /// What a checkpoint must keep.
  virtual Record save() const { return {}; }
  virtual void load(const Record&) {}

  /// The body force on a cell in the coming step, lattice units; the fluid tells it.
  void set_body_force(const Vec3& force) { body_force_ = force; }

 protected:
  Vec3 body_force_ = Vec3::Zero();  // rho u = Σ c f + F/2
};

/// @param scheme            not the immersed moving boundary; in three dimensions links only
/// @param spring_stiffness  of the spring scheme, force a surface element and stretch
/// @throws std::invalid_argument where a scheme is no pass of its own
std::unique_ptr<BodyScheme> make_scheme(SolidScheme scheme, const Domain& domain,
                                        const Lattice& lattice, double spring_stiffness = 0.001);

}  // namespace lbm
