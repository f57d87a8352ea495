// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/viscosity/viscosity_law.h"

#include <algorithm>
#include <cmath>

namespace lbm {
namespace {

using Model = ViscosityScene::Model;

constexpr double kSpan = 100.0;      // bounds over and under the reference, where none are given
constexpr double kSlowest = 1e-290;  // a shear rate that is none, but may be divided by

struct Row {
  Model model;
  const char* name;
  ViscosityParts parts;
};

const Row kRows[] = {
    {Model::Newtonian, "newtonian", {}},
    {Model::Smagorinsky, "smagorinsky", {}},
    {Model::PowerLaw, "power_law", {.varies = true, .consistency = true, .index = true}},
    {Model::Carreau,
     "carreau",
     {.varies = true, .index = true, .time_constant = true, .bounds = true}},
    {Model::Bingham, "bingham", {.varies = true, .consistency = true, .yield_stress = true}},
    {Model::HerschelBulkley,
     "herschel_bulkley",
     {.varies = true, .consistency = true, .index = true, .yield_stress = true}},
};

const Row& row_of(Model model) {
  return *std::ranges::find(kRows, model, &Row::model);
}

}  // namespace

ViscosityLaw::ViscosityLaw(const FluidScene& fluid, double shear_rate)
    : scene_(fluid.law),
      newtonian_(fluid.viscosity),
      consistency_(fluid.law.consistency / fluid.density),
      yield_(fluid.law.yield_stress / fluid.density),
      shear_rate_(shear_rate) {
  const bool bounded = fluid.law.nu_min && fluid.law.nu_max;
  const double middle = newtonian() ? newtonian_ : bounded ? 0.0 : unbounded(shear_rate);
  const bool bingham = scene_.model == Model::Bingham;
  nu_min_ =
      fluid.law.nu_min.value_or(bingham ? std::min(middle / kSpan, consistency_) : middle / kSpan);
  nu_max_ = fluid.law.nu_max.value_or(middle * kSpan);
}

bool ViscosityLaw::newtonian() const {
  return !parts_of(scene_.model).varies;
}

double ViscosityLaw::unbounded(double shear_rate) const {
  const double rate = std::max(shear_rate, kSlowest), n = scene_.index;
  if (scene_.model == Model::Carreau)
    return nu_min_ + (nu_max_ - nu_min_) *
                         std::pow(1.0 + std::pow(scene_.time_constant * rate, 2), 0.5 * (n - 1.0));
  double yielded = yield_ / rate;
  if (scene_.regularisation == ViscosityScene::Regularisation::Papanastasiou && yield_ > 0.0 &&
      nu_max_ > 0.0)
    yielded *= -std::expm1(-nu_max_ / yield_ * rate);
  return consistency_ * std::pow(rate, n - 1.0) + yielded;
}

double ViscosityLaw::operator()(double shear_rate) const {
  if (newtonian()) return newtonian_;
  return std::clamp(unbounded(shear_rate), nu_min_, nu_max_);
}

double typical_shear_rate(const Scene& s) {
  const int d = s.box.dimension;
  double length = 0.0;
  const auto look = [&length](double candidate) {
    length = length > 0.0 ? std::min(length, candidate) : candidate;
  };
  if (s.particles) look(s.particles->diameter.lo);
  for (const ObstacleScene& o : s.obstacles)
    if (o.round) look(o.diameter);
  for (int k = 0; k < d; ++k)
    if (s.box.sides[k] == SideKind::Wall) look(0.5 * s.box.size[k]);
  return s.fluid.velocity_scale / (length > 0.0 ? length : s.box.size.head(d).minCoeff());
}

ViscosityParts parts_of(Model model) {
  return row_of(model).parts;
}

std::vector<Model> known_viscosities() {
  std::vector<Model> models;
  for (const Row& row : kRows) models.push_back(row.model);
  return models;
}

std::string name_of(Model model) {
  return row_of(model).name;
}

}  // namespace lbm
