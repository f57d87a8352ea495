// SPDX-License-Identifier: GPL-2.0-or-later
#include "tests/performance/array_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lbm_solver/immersed/resistance.h"
#include "lbm_solver/solver/fluid.h"
#include "tests/support/array_references.h"
#include "tests/support/free_disc.h"

namespace lbm {
namespace {

using std::numbers::pi;

/// A square array of discs or a simple cubic one of spheres.
struct Array {
  int dimension;
  double fraction;
  double drag;  ///< discs: F/(μU); spheres: F/(6πμaU)

  double radius(int cells) const {
    return cells * (dimension == 2 ? std::sqrt(fraction / pi) : std::cbrt(0.75 * fraction / pi));
  }
  /// Force over mu U in lattice units.
  double exact(int cells) const { return dimension == 2 ? drag : 6.0 * pi * radius(cells) * drag; }
  double volume(int cells) const { return std::pow(cells, dimension); }
  const char* name() const { return dimension == 2 ? "disc" : "sphere"; }
};

std::vector<Array> arrays(int dimension, const std::map<double, double>& drag) {
  std::vector<Array> list;
  for (const auto& [fraction, value] : drag) list.push_back({dimension, fraction, value});
  return list;
}
const std::vector<Array> kDiscs = arrays(2, test::kDiscDrag),
                         kSpheres = arrays(3, test::kSphereDrag);
const std::vector<double> kDiameters{4, 5, 6, 8, 10, 16};
const std::vector<Vec3>& kPlaces = test::kPlacesInACell;

struct Term {
  SolidTerm term;
  std::string what;
};
const std::vector<Term> kTerms{{SolidTerm::Resistance, "default, bodies at rest"},
                               {SolidTerm::LayeredResistance, "default, free bodies"},
                               {SolidTerm::Holdych, "former default, bodies at rest"},
                               {SolidTerm::LayeredHoldych, "former default, free bodies"}};

/// Mean over the box of rho u along an axis of what has arrived, half of the body force in it.
double momentum(const Fluid& fluid, int axis = 0) {
  const Domain& d = fluid.domain();
  double sum = 0.0;
  for (int z = 0; z < d.nz; ++z)
    for (int y = 0; y < d.ny; ++y)
      for (int x = 0; x < d.nx; ++x) {
        const Fluid::Cell cell = fluid.cell(x, y, z);
        sum += cell.rho * cell.u[axis];
      }
  return sum / (1.0 * d.nx * d.ny * d.nz);
}

/// Mean flux along x. In steady flow Σ c f of what arrives, without half of the body force, is the
/// flux through any face between cells, also where these are covered: over the whole box bodies
/// take as much as the force gives. Cells inside of a body may ring from one step to the next, so
/// it is the mean of two steps.
double flux(Fluid& fluid, double half_force) {
  const double first = momentum(fluid);
  fluid.step();
  const double second = momentum(fluid);
  fluid.step();
  return 0.5 * (first + second) - half_force;
}

/// An array in a fluid that a body force drives along x.
struct Flow {
  Flow(const Array& a, SolidTerm term, int cells, double tau, double reynolds)
      : array(a), cells(cells), nu((tau - 0.5) / 3.0), radius(a.radius(cells)) {
    u = reynolds * nu / (2.0 * radius);
    g = a.exact(cells) * nu * u / a.volume(cells);
    relaxation = a.volume(cells) / (a.exact(cells) * nu);
    choice = {
        .force = true,
        .solid_term = term,
        .parameters = {.tau = tau, .magic = by_resistance(term) ? kResistanceMagic : 3.0 / 16.0},
        .weight = a.dimension == 2 ? WeightRule::Viscous : WeightRule::Balanced,
        .lattice = a.dimension == 2 ? VelocitySet::D2Q9 : VelocitySet::D3Q19};
  }
  /// @param sense  1: the fluid is driven along x, -1: against it
  Fluid fluid(double sense) const {
    KernelChoice driven = choice;
    driven.parameters.force_x = sense * g;
    return {box(), driven};
  }
  Domain box() const {
    return array.dimension == 2
               ? Domain{cells, cells, Side::Periodic, Side::Periodic}
               : Domain{cells, cells, Side::Periodic, Side::Periodic, cells, Side::Periodic};
  }
  /// The body at a place in a cell in the middle of the box.
  Body body(const Vec3& place, const Vec3& velocity) const {
    const double middle = cells / 2;  // a whole number
    Vec3 centre = Vec3(middle, middle, middle) + place;
    if (array.dimension == 2) centre.z() = 0.0;
    return {1, centre, radius, velocity, Spin()};
  }

  const Array& array;
  int cells;
  double nu, radius;
  double u, g;        ///< mean flux and body force that belong to each other
  double relaxation;  ///< steps, of the mean flux
  KernelChoice choice;
};

/// Error of the drag at rest, Re_D = 0.01; not a number where it comes to no end. What cells below
/// the surface hold leaves them slowly, in some 1000 steps, however fast the flow itself is.
double error_of(const Array& array, SolidTerm term, int cells, double tau, const Vec3& place) {
  const Flow flow(array, term, cells, tau, 0.01);
  Fluid fluid = flow.fluid(1.0);
  fluid.place(std::vector{flow.body(place, Vec3())});
  constexpr int between = 100;
  double before = 0.0;
  for (double step = 0; step < 20000.0 + 60.0 * flow.relaxation; step += between + 2) {
    fluid.advance(between);
    const double now = flux(fluid, 0.5 * flow.g);
    if (!(std::abs(now) < 1e3 * flow.u)) break;
    const double left = std::abs(now - before) * std::max(10.0, flow.relaxation / between);
    if (step > 400.0 + 3.0 * flow.relaxation && left < 1e-5 * std::abs(now))
      return flow.u / now - 1.0;
    before = now;
  }
  return std::nan("");
}

/// Bodies that move through the lattice at Re_D = 0.1 while the fluid is driven against them:
/// error of the mean force and its standard deviation over the passage of four cells.
nlohmann::json moving_row(const Array& array, SolidTerm term, int cells, double tau) {
  const Flow flow(array, term, cells, tau, 0.1);
  Fluid fluid = flow.fluid(-1.0);
  Body body = flow.body({0.0, 0.23, 0.41}, {flow.u, 0.0, 0.0});
  const auto start = static_cast<int>(500.0 + 20.0 * flow.relaxation);
  const auto steps = static_cast<int>(std::ceil(4.0 / flow.u));
  double relative = 0.0, sum = 0.0, squares = 0.0;
  for (int step = 0; step < start + steps; ++step) {
    fluid.place(std::vector{body});
    fluid.step();
    body.centre.x() = std::fmod(body.centre.x() + flow.u, cells);
    if (step < start) continue;
    const double force = -fluid.loads()[0].force.x() / steps;
    sum += force;
    squares += force * force * steps;
    relative += (flow.u - momentum(fluid) - 0.5 * flow.g) / steps;
  }
  return {{"body", array.name()},
          {"solid_term", name_of(term)},
          {"fraction", array.fraction},
          {"tau", tau},
          {"cells", cells},
          {"diameter", 2.0 * flow.radius},
          {"error_percent", 100.0 * (sum / (flow.nu * relative) / array.exact(cells) - 1.0)},
          {"sigma_percent", 100.0 * std::sqrt(std::max(0.0, squares - sum * sum)) / sum}};
}

/// Bodies that move by their weight at Re_D = 0.1, the fluid driven against them as hard, with all
/// that a coupled run does to their loads: error of the drag, which is known, by their speed
/// against the flux, and the standard deviation of the force over the passage of four cells.
nlohmann::json free_row(const Array& array, SolidTerm term, int cells, double ratio) {
  const Flow flow(array, term, cells, 1.0, 0.1);
  KernelChoice driven = flow.choice;
  driven.parameters.force_y = flow.g;
  Fluid fluid(flow.box(), driven);
  Scene scene;
  const double body_volume = array.fraction * array.volume(cells);
  const double weight = flow.g * array.volume(cells);  // less the displaced fluid's
  scene.fluid = {.density = 1.0,
                 .viscosity = flow.nu,
                 .gravity = {0.0, -weight / ((ratio - 1.0) * body_volume), 0.0}};
  scene.coupling.emplace();
  scene.particles.emplace();
  const auto start = static_cast<int>(500.0 + 20.0 * (1.0 + ratio) * flow.relaxation);
  const auto steps = static_cast<int>(std::ceil(4.0 / flow.u));
  int step = 0;
  double flux = 0.0, speed = 0.0, sum = 0.0, squares = 0.0;
  const auto see = [&] {
    if (step++ >= start) flux += (momentum(fluid, 1) - 0.5 * flow.g) / steps;
  };
  const test::FreeRun run = test::free_run(fluid, scene,
                                           {.ratio = ratio,
                                            .radius = flow.radius,
                                            .start = flow.body({0.23, 0.0, 0.41}, Vec3()).centre,
                                            .steps = start + steps,
                                            .solid_term = term,
                                            .seen = see});
  for (int k = start; k < start + steps; ++k) {
    speed -= run.velocity[k].y() / steps;
    sum += run.force_y[k] / steps;
    squares += run.force_y[k] * run.force_y[k] / steps;
  }
  const double relative = speed + flux;
  return {{"body", array.name()},
          {"solid_term", name_of(term)},
          {"fraction", array.fraction},
          {"ratio", ratio},
          {"cells", cells},
          {"diameter", 2.0 * flow.radius},
          {"error_percent", 100.0 * (weight / (flow.nu * relative) / array.exact(cells) - 1.0)},
          {"sigma_percent", 100.0 * std::sqrt(std::max(0.0, squares - sum * sum)) / weight}};
}

struct Job {
  const Array* array;
  SolidTerm term;
  int cells;
  double tau;
  std::vector<double> errors = std::vector<double>(kPlaces.size());

  nlohmann::json row() const {
    double mean = 0.0;
    for (const double e : errors) mean += 100.0 * e / static_cast<double>(errors.size());
    const auto [least, largest] = std::minmax_element(errors.begin(), errors.end());
    return {{"body", array->name()},
            {"solid_term", name_of(term)},
            {"fraction", array->fraction},
            {"tau", tau},
            {"cells", cells},
            {"diameter", 2.0 * array->radius(cells)},
            {"error_percent", mean},
            {"spread_percent", 100.0 * (*largest - *least)}};
  }
};

/// Cells a period, a whole number, for about a diameter.
int cells_for(const Array& array, double diameter) {
  return static_cast<int>(std::lround(diameter / (2.0 * array.radius(1000) / 1000.0)));
}

std::string text_of(const nlohmann::json& row) {
  const double error = row["error_percent"];
  if (!std::isfinite(error)) return " no end |";
  return fmt::format(" {:+.2f} ({:.2f}) D{:.1f} |", error, row["spread_percent"].get<double>(),
                     row["diameter"].get<double>());
}

/// At rest: all terms and arrays, then one array at some relaxation times.
nlohmann::json table_at_rest() {
  std::vector<Job> jobs;
  for (const Term& t : kTerms)
    for (const auto* arrays : {&kDiscs, &kSpheres})
      for (const Array& a : *arrays)
        for (const double d : kDiameters) jobs.push_back({&a, t.term, cells_for(a, d), 1.0});
  const std::vector<double> taus{0.505, 0.6, 1.0, 1.5, 2.0};
  for (const Term& t : kTerms)
    for (const double tau : taus) jobs.push_back({&kDiscs[2], t.term, 20, tau});
  const std::size_t runs = jobs.size() * kPlaces.size();
#pragma omp parallel for schedule(dynamic)
  for (std::size_t i = 0; i < runs; ++i) {
    Job& j = jobs[i / kPlaces.size()];
    const std::size_t place = i % kPlaces.size();
    j.errors[place] = error_of(*j.array, j.term, j.cells, j.tau, kPlaces[place]);
  }

  nlohmann::json list = nlohmann::json::array();
  std::size_t job = 0;
  const auto print = [&](std::size_t columns) {
    for (std::size_t i = 0; i < columns; ++i) {
      list.push_back(jobs[job++].row());
      fmt::print("{}", text_of(list.back()));
    }
    fmt::print("\n");
  };
  for (const Term& t : kTerms) {
    fmt::print("\n| {}: {}, τ 1 |", t.what, name_of(t.term));
    for (const double d : kDiameters) fmt::print(" D about {} |", d);
    fmt::print("\n|---|---|---|---|---|---|---|\n");
    for (const auto* arrays : {&kDiscs, &kSpheres})
      for (const Array& a : *arrays) {
        fmt::print("| {}s, c = {} |", a.name(), a.fraction);
        print(kDiameters.size());
      }
  }
  fmt::print("\n| discs, c = 0.2 |");
  for (const double tau : taus) fmt::print(" τ {} |", tau);
  fmt::print("\n|---|---|---|---|---|---|\n");
  for (const Term& t : kTerms) {
    fmt::print("| {}: {} |", t.what, name_of(t.term));
    print(taus.size());
  }
  return list;
}

/// Moving discs: the terms for free bodies.
nlohmann::json table_of_moving() {
  struct Passage {
    const Array* array;
    const Term* term;
    int cells;
    nlohmann::json row;
  };
  std::vector<Passage> passages;
  for (const Array* a : {&kDiscs[2], &kDiscs[4]})
    for (const Term* t : {&kTerms[1], &kTerms[3]})
      for (const double d : {6.0, 10.0}) passages.push_back({a, t, cells_for(*a, d), {}});
#pragma omp parallel for schedule(dynamic)
  for (Passage& p : passages) p.row = moving_row(*p.array, p.term->term, p.cells, 1.0);
  fmt::print("\n| moving discs, τ 1 | D | error % | σ % |\n|---|---|---|---|\n");
  nlohmann::json list = nlohmann::json::array();
  for (const Passage& p : passages) {
    fmt::print("| {}, c = {} | {:.1f} | {:+.2f} | {:.2f} |\n", name_of(p.term->term),
               p.array->fraction, p.row["diameter"].get<double>(),
               p.row["error_percent"].get<double>(), p.row["sigma_percent"].get<double>());
    list.push_back(p.row);
  }
  return list;
}

/// Free discs and spheres, dilute and dense, light and heavy.
nlohmann::json table_of_free() {
  struct Passage {
    const Array* array;
    const Term* term;
    int cells;
    double ratio;
    nlohmann::json row;
  };
  std::vector<Passage> passages;
  for (const Array* a : {&kDiscs[2], &kDiscs[4], &kSpheres[1], &kSpheres[2]})
    for (const Term* t : {&kTerms[1], &kTerms[3]})
      for (const double d : {6.0, 10.0})
        for (const double ratio : {1.25, 2.65})
          passages.push_back({a, t, cells_for(*a, d), ratio, {}});
#pragma omp parallel for schedule(dynamic)
  for (Passage& p : passages) p.row = free_row(*p.array, p.term->term, p.cells, p.ratio);
  fmt::print(
      "\n| free bodies, τ 1 | c | D | density | error % | σ % |\n|---|---|---|---|---|---|\n");
  nlohmann::json list = nlohmann::json::array();
  for (const Passage& p : passages) {
    fmt::print("| {}s, {} | {} | {:.1f} | {} | {:+.2f} | {:.2f} |\n", p.array->name(),
               name_of(p.term->term), p.array->fraction, p.row["diameter"].get<double>(), p.ratio,
               p.row["error_percent"].get<double>(), p.row["sigma_percent"].get<double>());
    list.push_back(p.row);
  }
  return list;
}

}  // namespace

nlohmann::json array_table() {
  return {{"rest", table_at_rest()}, {"moving", table_of_moving()}, {"free", table_of_free()}};
}

}  // namespace lbm
