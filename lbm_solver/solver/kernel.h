// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>

#include "lbm_solver/base/choices.h"
#include "lbm_solver/collision/parameters.h"
#include "lbm_solver/field/esoteric_pull.h"
#include "lbm_solver/immersed/cover_map.h"
#include "lbm_solver/immersed/weight.h"
#include "lbm_solver/viscosity/eddy_field.h"

namespace lbm {

/// The rows of some layers of a lattice, numbered through: y runs first.
struct Rows {
  int y_begin = 0, y_end = 0, z_begin = 0, z_end = 1;

  static Rows all(const Populations& f) { return {0, f.ny(), 0, f.nz()}; }
  int size() const { return (y_end - y_begin) * (z_end - z_begin); }
  std::pair<int, int> operator[](int r) const {
    const int n = y_end - y_begin;
    return {y_begin + r % n, z_begin + r / n};
  }
};

/// One sweep of the lattice: stream and collide cells. The only virtual call of a time step.
class Kernel {
 public:
  virtual ~Kernel() = default;
  /// Called by every thread of a parallel region, each for its share of the rows; returns without
  /// waiting for the others. @param cover  covered cells; null where the scene has no solids
  /// @param eddies  null: the eddy viscosity is Smagorinsky's everywhere
  virtual void sweep(Populations& f, const EsotericPull& stream, CoverMap* cover,
                     const EddyField* eddies, const Rows& rows) const = 0;
};

/// What a scene asks of the kernel; a row of the kernel table.
struct KernelChoice {
  CollisionOperator collision = CollisionOperator::Trt;
  bool force = false;  ///< uniform body force
  SolidTerm solid_term = SolidTerm::None;
  CollisionParameters parameters;
  WeightRule weight = WeightRule::Viscous;
  VelocitySet lattice = VelocitySet::D2Q9;
  Precision precision = Precision::Double;
  EddyModel eddies = EddyModel::Smagorinsky;

  /// The viscosity depends on the shear rate of a cell: by its table, or by Smagorinsky's model.
  bool local_viscosity() const {
    return parameters.smagorinsky > 0.0 || parameters.viscosity_table;
  }
};

/// @throws std::invalid_argument naming the rows that exist
std::unique_ptr<Kernel> make_kernel(const KernelChoice& choice);

}  // namespace lbm
