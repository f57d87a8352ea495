// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/io/cell_fields.h"
#include "lbm_solver/solver/fluid.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// What a frame shows of every cell, in SI units: pressure, velocity and, where there are solids,
/// what they cover. The fluid must outlive it.
/// @param viscosity  that too
CellFields shown_cells(Fluid& fluid, const Plan& plan, bool viscosity);

/// The images among a scene's obstacles.
std::vector<Geometry> image_solids(const Scene& scene, const Plan& plan);

/// Adds `image_fraction`: what images cover of each cell, which tells them from grains and other
/// obstacles.
void add_images(const std::vector<Geometry>& images, const Fluid& fluid, CellFields& shown);

/// Mean over the box of the momentum that has arrived in its cells; before the first step that of
/// the initial velocity of the fluid, as nothing has arrived (what is there lacks half of a body
/// force). It is added up in whole
/// numbers: the same bit for bit on any ranks. Collective.
Vec3 mean_arrived_momentum(const Fluid& fluid);

}  // namespace lbm
