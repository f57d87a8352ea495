// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/fluid.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include "lbm_solver/base/contracts.h"
#include "lbm_solver/base/simd.h"
#include "lbm_solver/collision/equilibrium.h"
#include "lbm_solver/immersed/disc_fraction.h"

namespace lbm {

Fluid::Fluid(const Domain& domain, const KernelChoice& choice)
    : domain_(domain),
      f_(domain.nx, domain.ny),
      stream_(domain.x, domain.y),
      kernel_(make_kernel(choice)),
      half_force_(choice.force ? 0.5 * choice.parameters.force_x : 0.0,
                  choice.force ? 0.5 * choice.parameters.force_y : 0.0),
      cover_(choice.solid_term == "none"
                 ? nullptr
                 : std::make_unique<CoverMap>(
                       domain, choice.turbulence == "none"
                                   ? ImmersedWeight{choice.weight, choice.parameters.tau}
                                   : ImmersedWeight{WeightRule::Fraction})) {}

void Fluid::set_equilibrium(int x, int y, double rho, const Vec2& u) {
  const Vec2 before = u - half_force_ / rho;  // the step adds the other half of a body force
  const Equilibrium<double> eq(rho - 1.0, before.x(), before.y());
  arriving(0, x, y) = eq.rest();
  unroll<D2Q9::pairs>([&](auto p) {
    constexpr int i = 2 * p + 1;
    const auto halves = eq.pair<i>();
    arriving(i, x, y) = halves.even + halves.odd;
    arriving(i + 1, x, y) = halves.even - halves.odd;
  });
}

void Fluid::place(std::span<const Disc> discs) {
  BPLBM_EXPECT(has_solids());
  if (scheme_)
    discs_.assign(discs.begin(), discs.end());
  else
    cover_->update(discs);
}

double Fluid::solid_fraction(int x, int y) const {
  double sum = cover_ ? cover_->solid_fraction(x, y) : 0.0;
  for (const Disc& disc : discs_) {
    Vec2 arm = Vec2(x + 0.5, y + 0.5) - disc.centre;
    if (domain_.x == Side::Periodic) arm.x() -= domain_.nx * std::round(arm.x() / domain_.nx);
    if (domain_.y == Side::Periodic) arm.y() -= domain_.ny * std::round(arm.y() / domain_.ny);
    const double fraction = disc_fraction(arm.x(), arm.y(), disc.radius);
    sum += disc.hollow ? 1.0 - fraction : fraction;
  }
  return std::min(1.0, sum);
}

void Fluid::advance(std::int64_t steps) {
  const bool passes = scheme_ || !patches_.empty();
#pragma omp parallel
  {
    flush_denormals();
    EsotericPull stream = stream_;  // every thread turns its own, so that a sweep has one barrier
    for (std::int64_t s = 1; s <= steps; ++s) {
      if (scheme_) {
#pragma omp single
        scheme_->before_sweep(discs_, f_, stream);
      }
      kernel_->sweep(f_, stream, cover_.get());
      stream.advance();
      if (!passes && s == steps) break;  // the end of the region is the barrier
#pragma omp barrier
      if (!passes) continue;
#pragma omp single
      {
        if (scheme_) scheme_->after_sweep(f_, stream);
        for (const auto& patch : patches_) patch->apply(f_, stream, steps_ + s);
      }
    }
  }
  if (steps % 2 != 0) stream_.advance();
  steps_ += steps;
}

Fluid::Cell Fluid::cell(int x, int y) const {
  double f[D2Q9::Q];
  for (int q = 0; q < D2Q9::Q; ++q) f[q] = arriving(q, x, y);
  const Moments<double> m = moments(f);
  return {m.drho + 1.0, (Vec2(m.jx, m.jy) + half_force_) / (m.drho + 1.0)};
}

Fluid::Cell Fluid::at(const Vec2& place) const {
  const auto split = [](double v, int n) {
    const double inside = std::clamp(v - 0.5, 0.0, static_cast<double>(n - 1));
    const int low = std::min(static_cast<int>(inside), n - 2);
    return std::pair{low, inside - low};
  };
  const auto [x, fx] = split(place.x(), domain_.nx);
  const auto [y, fy] = split(place.y(), domain_.ny);
  Cell sum{0.0, {0.0, 0.0}};
  for (const auto& [dx, dy, weight] : {std::tuple{0, 0, (1 - fx) * (1 - fy)},
                                       {1, 0, fx * (1 - fy)},
                                       {0, 1, (1 - fx) * fy},
                                       {1, 1, fx * fy}}) {
    const Cell c = cell(x + dx, y + dy);
    sum.rho += weight * c.rho;
    sum.u += weight * c.u;
  }
  return sum;
}

void Fluid::row(int y, std::span<double> rho, std::span<double> ux, std::span<double> uy) {
  const EsotericPull::Row row = stream_.open(f_, y);  // makes the ends ready; may be repeated
  const auto cells = [&]<class V>(int x) {
    V f[D2Q9::Q];
    unroll<D2Q9::Q>([&](auto q) { f[q] = load<V>(row.in[q] + x); });
    const Moments<V> m = moments(f);
    store(&rho[x], m.drho + V(1.0));
    const V inverse = V(1.0) / (m.drho + V(1.0));
    store(&ux[x], (m.jx + V(half_force_.x())) * inverse);
    store(&uy[x], (m.jy + V(half_force_.y())) * inverse);
  };
  int x = 0;
  for (; x + kPackWidth <= domain_.nx; x += kPackWidth) cells.operator()<Pack>(x);
  for (; x < domain_.nx; ++x) cells.operator()<double>(x);
}

Fluid::Extremes Fluid::extremes() {
  Extremes e;
  double largest = 0.0;
  std::vector<double> rho(domain_.nx), ux(domain_.nx), uy(domain_.nx);
  for (int y = 0; y < domain_.ny; ++y) {
    row(y, rho, ux, uy);
    for (int x = 0; x < domain_.nx; ++x) {
      const double speed2 = ux[x] * ux[x] + uy[x] * uy[x];
      e.mass_excess += rho[x] - 1.0;
      if (!std::isfinite(rho[x] + speed2)) return {speed2, x, y, false, 0.0};
      if (speed2 <= largest) continue;
      largest = speed2;
      e.x = x;
      e.y = y;
    }
  }
  e.max_speed = std::sqrt(largest);
  return e;
}

std::map<std::string, std::vector<double>> Fluid::state() const {
  std::map<std::string, std::vector<double>> state;
  state["populations"].assign(f_.raw().begin(), f_.raw().end());
  state["clock"] = {static_cast<double>(steps_), stream_.odd() ? 1.0 : 0.0};
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    std::vector<double>& values = state["patch" + std::to_string(i)];
    values = patches_[i]->memory();
    values.push_back(patches_[i]->mass_in());
  }
  if (scheme_) state["scheme"] = scheme_->memory();
  return state;
}

void Fluid::restore(const std::map<std::string, std::vector<double>>& state) {
  const auto take = [&state](const std::string& name,
                             std::size_t size) -> const std::vector<double>& {
    const auto found = state.find(name);
    if (found == state.end() || found->second.size() != size)
      throw std::invalid_argument("'" + name + "' is missing or of another size");
    return found->second;
  };
  const auto& populations = take("populations", f_.raw().size());
  const auto& clock = take("clock", 2);
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    std::vector<double>& memory = patches_[i]->memory();
    const auto& values = take("patch" + std::to_string(i), memory.size() + 1);
    std::copy_n(values.begin(), memory.size(), memory.begin());
    patches_[i]->restore_mass(values.back());
  }
  if (scheme_) scheme_->restore(state.at("scheme"));
  std::copy(populations.begin(), populations.end(), f_.raw().begin());
  steps_ = static_cast<std::int64_t>(clock[0]);
  stream_.set_odd(clock[1] != 0.0);
}

}  // namespace lbm
