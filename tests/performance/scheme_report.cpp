// SPDX-License-Identifier: GPL-2.0-or-later
/// `scheme_report [--quick] [--cells N …] [--filter TEXT] [--fractions|--arrays] [--json FILE]`:
/// every fluid-solid scheme on the same two cases.
///
/// Fixed disc: square array of cylinders in Stokes flow, c = 0.2, F/(mu U) of array_references.h
/// (spectral, agrees with Sangani and Acrivos 1982): error in per cent at D/h = 5, 10, 20 and four
/// relaxation times, mean and spread over three places of the disc within its cell. Translating
/// disc: the same array, the disc moving at Re_D = 1 through the lattice: error of the mean force,
/// its standard deviation and largest departure over the passage of cells. Solid fraction: error
/// and cost of chords, exact area and sample points. Cost: a step with 49 moving discs of ten cells
/// (10 % of 200²) over a step without solids.
/// --arrays: the drag of discs and spheres by solid fraction and size alone (array_table.h).
#include <fmt/format.h>
#include <omp.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "lbm_solver/immersed/resistance.h"
#include "lbm_solver/immersed/solid_fraction.h"
#include "lbm_solver/solver/fluid.h"
#include "protocol/program/command_line.h"
#include "tests/performance/array_table.h"
#include "tests/reference/disc_area.h"
#include "tests/support/array_references.h"
#include "tests/support/scheme_fluid.h"

namespace {

using namespace lbm;

constexpr double kFraction = 0.2;
const double kDrag = test::kDiscDrag.at(kFraction);

struct Row {
  std::string name;
  CollisionOperator collision;
  test::Case solids;
  WeightRule weight = WeightRule::Viscous;
};

const std::vector<Row> kRows{
    {"default, bodies at rest: TRT, resistance", CollisionOperator::Trt, SolidTerm::Resistance},
    {"default, free bodies: TRT, layered resistance", CollisionOperator::Trt,
     SolidTerm::LayeredResistance},
    {"default above Re_h 5: CM, layered Noble–Torczynski, B(ε,τ)", CollisionOperator::CentralMoment,
     SolidTerm::LayeredNobleTorczynski},
    {"papers: BGK, Noble–Torczynski, B(ε,τ)", CollisionOperator::Bgk, SolidTerm::NobleTorczynski},
    {"BGK, Noble–Torczynski, B = ε", CollisionOperator::Bgk, SolidTerm::NobleTorczynski,
     WeightRule::Fraction},
    {"TRT, Noble–Torczynski, B(ε,τ)", CollisionOperator::Trt, SolidTerm::NobleTorczynski},
    {"TRT, Holdych, B(ε,τ)", CollisionOperator::Trt, SolidTerm::Holdych},
    {"TRT, layered Holdych, B(ε,τ)", CollisionOperator::Trt, SolidTerm::LayeredHoldych},
    {"TRT, Holdych, B = ε", CollisionOperator::Trt, SolidTerm::Holdych, WeightRule::Fraction},
    {"BGK, superposition, B(ε,τ)", CollisionOperator::Bgk, SolidTerm::Superposition},
    {"TRT, superposition, B = ε", CollisionOperator::Trt, SolidTerm::Superposition,
     WeightRule::Fraction},
    {"BGK, bounce-back (staircase)", CollisionOperator::Bgk, SolidScheme::BounceBack},
    {"TRT, bounce-back (staircase)", CollisionOperator::Trt, SolidScheme::BounceBack},
    {"TRT, interpolated bounce-back", CollisionOperator::Trt, SolidScheme::InterpolatedBounceBack},
    {"BGK, implicit immersed boundary", CollisionOperator::Bgk,
     SolidScheme::ImplicitImmersedBoundary},
    {"TRT, implicit immersed boundary", CollisionOperator::Trt,
     SolidScheme::ImplicitImmersedBoundary},
    {"BGK, spring immersed boundary", CollisionOperator::Bgk, SolidScheme::SpringImmersedBoundary},
};

Fluid make(const Row& row, const Domain& domain, double tau, const Vec3& force) {
  KernelChoice choice{
      .collision = row.collision,
      .force = force.norm() > 0.0,
      .solid_term = row.solids.term,
      .parameters = {.tau = tau,
                     .magic = by_resistance(row.solids.term) ? kResistanceMagic : 3.0 / 16.0,
                     .force_x = force.x(),
                     .force_y = force.y()},
      .weight = row.weight};
  Fluid fluid(domain, choice);
  if (!row.solids.covers()) fluid.use(make_scheme(row.solids.scheme, domain, fluid.lattice()));
  for (int y = 0; y < domain.ny; ++y)
    for (int x = 0; x < domain.nx; ++x) fluid.set_equilibrium(x, y, 1.0, {0.0, 0.0});
  return fluid;
}

/// Mean velocity of what arrived over all cells [x0, x1) of the box, whatever covers them.
double mean_velocity(const Fluid& fluid, int x0, int x1) {
  const int ny = fluid.domain().ny;
  double sum = 0.0;
  for (int y = 0; y < ny; ++y)
    for (int x = x0; x < x1; ++x) sum += fluid.cell(x, y).u.x();
  return sum / ((x1 - x0) * ny);
}

double radius_of(int n) {
  return n * std::sqrt(kFraction / std::numbers::pi);
}

/// Error of the drag of a fixed disc, 1; not a number where it blows up.
double fixed_disc(const Row& row, int n, double tau, const Vec3& offset) {
  const double nu = (tau - 0.5) / 3.0, r = radius_of(n);
  const double u = 0.01 * nu / (2.0 * r);  // Re_D = 0.01
  const double g = kDrag * nu * u / (n * n);
  const Domain domain{n, n, Side::Periodic, Side::Periodic};
  Fluid fluid = make(row, domain, tau, {g, 0.0});
  const std::vector<Body> discs{{1, Vec3(n / 2, n / 2) + offset, r, {0.0, 0.0}, 0.0}};
  const double relaxation = 0.0155 * n * n / nu;
  const auto last = static_cast<long>(std::max(2000.0, 40.0 * relaxation));
  double before = 0.0, now = 0.0;
  for (long step = 1; step <= last; ++step) {
    fluid.place(discs);
    fluid.step();
    if (step % 200 != 0) continue;
    now = mean_velocity(fluid, 0, 1);
    if (!(std::abs(now) < 1e3 * u)) return std::nan("");
    if (step > 5.0 * relaxation && std::abs(now - before) < 3e-6 * std::abs(now) * 200 / relaxation)
      break;
    before = now;
  }
  return g * n * n / (nu * now) / kDrag - 1.0;
}

struct Translation {
  double error = std::nan(""), sigma = std::nan(""), peak = std::nan("");
};

Translation translating_disc(const Row& row, int n, double tau) {
  const double nu = (tau - 0.5) / 3.0, r = radius_of(n), u0 = nu / (2.0 * r);  // Re_D = 1
  const double g = -kDrag * nu * u0 / (n * n);
  const Domain domain{n, n, Side::Periodic, Side::Periodic};
  Fluid fluid = make(row, domain, tau, {g, 0.0});
  Body disc{1, {0.5 * n, 0.5 * n + 0.23}, r, {u0, 0.0}, 0.0};
  const double relaxation = 0.0155 * n * n / nu;
  const auto start = static_cast<long>(30.0 * relaxation);
  const auto steps = static_cast<long>(std::ceil(4.0 / u0));  // the passage of four cells
  std::vector<double> forces;
  double relative = 0.0;
  for (long step = 0; step < start + steps; ++step) {
    fluid.place(std::vector{disc});
    fluid.step();
    const double force = -fluid.loads()[0].force.x();
    disc.centre.x() = std::fmod(disc.centre.x() + u0, n);
    if (step < start) continue;
    forces.push_back(force);
    if ((step - start) % 50 == 0) relative += u0 - mean_velocity(fluid, 0, n);
  }
  relative /= static_cast<double>((steps + 49) / 50);
  double mean = 0.0, square = 0.0, peak = 0.0;
  for (const double f : forces) mean += f / static_cast<double>(forces.size());
  for (const double f : forces) {
    square += (f - mean) * (f - mean) / static_cast<double>(forces.size());
    peak = std::max(peak, std::abs(f - mean));
  }
  if (!std::isfinite(mean)) return {};
  return {mean / (nu * relative) / kDrag - 1.0, std::sqrt(square) / mean, peak / mean};
}

/// Seconds a step on 200² with 49 moving discs, or without any.
double step_seconds(const Row& row, bool solids) {
  const int n = 200;
  const Domain domain{n, n, Side::Periodic, Side::Periodic};
  Row bare = row;
  if (!solids) bare.solids = SolidTerm::None;
  Fluid fluid = make(bare, domain, 0.6, {0.0, 0.0});
  std::vector<Body> discs;
  for (int i = 0; i < 49; ++i)
    discs.push_back({i + 1, {14.0 + 28.0 * (i % 7), 14.0 + 28.0 * (i / 7)}, 5.0, {0.01, 0.0}, 0.0});
  double best = 1e9;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    const int steps = 40;
    for (int s = 0; s < steps; ++s) {
      if (solids) fluid.place(discs);
      fluid.step();
      if (solids && fluid.loads().empty()) return 0.0;
      for (Body& d : discs) d.centre += d.velocity;
    }
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    best = std::min(best, spent.count() / steps);
  }
  return best;
}

/// Surface cells of discs of ten cells at many places: rms error of a rule, nanoseconds a disc.
template <class Rule>
nlohmann::json fraction_rule(const std::string& name, const Rule& rule) {
  constexpr int discs = 400;
  constexpr double radius = 5.0;
  double squares = 0.0, sum = 0.0;
  int cells = 0;
  const auto surface = [&](auto&& visit) {
    for (int d = 0; d < discs; ++d)
      for (int j = -6; j <= 6; ++j)
        for (int i = -6; i <= 6; ++i) {
          const double x = i + 0.61803 * d - std::floor(0.61803 * d);
          const double y = j + 0.75488 * d - std::floor(0.75488 * d);
          if (std::abs(std::hypot(x, y) - radius) < 0.7072) visit(x, y);
        }
  };
  surface([&](double x, double y) {
    const double error = rule(x, y, radius) - test::exact_fraction(x, y, radius);
    squares += error * error;
    ++cells;
  });
  const auto start = std::chrono::steady_clock::now();
  surface([&](double x, double y) { sum += rule(x, y, radius); });
  const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - start;
  const double rms = std::sqrt(squares / cells), nanoseconds = spent.count() / discs;
  fmt::print("| {} | {:.4f} | {:.0f} |\n", name, rms, sum > 0.0 ? nanoseconds : 0.0);
  return {{"rule", name}, {"rms", rms}, {"nanoseconds_a_disc", nanoseconds}};
}

/// Chords at some Gauss points across the axis that is nearer to the normal, each with a weight.
template <std::size_t N>
double chords(double x, double y, double r, const std::array<std::array<double, 2>, N>& points) {
  const double along = std::max(std::abs(x), std::abs(y));
  const double across = std::min(std::abs(x), std::abs(y));
  double sum = 0.0;
  for (const auto& [at, weight] : points)
    sum += weight * covered_length<double>(along, r * r - (across + at) * (across + at));
  return sum;
}

nlohmann::json fraction_rules() {
  using Rule = std::function<double(double, double, double)>;
  const auto on_grid = [](double n) -> Rule {
    return [n](double x, double y, double r) {
      return disc_fraction(std::round(n * x) / n, std::round(n * y) / n, r);
    };
  };
  const double far = std::sqrt(0.15);
  const std::vector<std::pair<std::string, Rule>> rules{
      {"chords at two Gauss points",
       [](double x, double y, double r) { return disc_fraction(x, y, r); }},
      {"the same, places on 1/128 of a cell (default)", on_grid(128)},
      {"the same, places on 1/16 of a cell", on_grid(16)},
      {"the same, places on 1/1024 of a cell", on_grid(1024)},
      {"a chord through the cell's middle",
       [](double x, double y, double r) {
         return chords<1>(x, y, r, {{{0.0, 1.0}}});
       }},
      {"chords at three Gauss points",
       [far](double x, double y, double r) {
         return chords<3>(x, y, r, {{{-far, 5.0 / 18}, {0.0, 8.0 / 18}, {far, 5.0 / 18}}});
       }},
      {"exact area", test::exact_fraction},
      {"5 × 5 points (the papers' way)",
       [](double x, double y, double r) { return test::sampled_fraction(x, y, r, 5); }},
      {"10 × 10 points",
       [](double x, double y, double r) { return test::sampled_fraction(x, y, r, 10); }}};
  fmt::print("\n| solid fraction | rms error | ns a disc, one cell at a time |\n|---|---|---|\n");
  nlohmann::json list = nlohmann::json::array();
  for (const auto& [name, rule] : rules) list.push_back(fraction_rule(name, rule));
  return list;
}

}  // namespace

int main(int argc, char** argv) {
  bool quick = false, names = false, fractions = false, arrays = false;
  std::vector<int> sizes{10, 20, 40};
  std::string json, filter;
  CLI::App app{"Error, noise and cost of every fluid-solid scheme on the same cases"};
  app.add_flag("--quick", quick, "D/h = 5 and 10 only");
  app.add_option("--cells", sizes, "cells a period; D/h is about half of it");
  app.add_option("--filter", filter, "rows whose name contains this text");
  app.add_flag("--list", names, "the rows' names, and nothing else");
  app.add_flag("--fractions", fractions, "the table of solid fractions alone");
  app.add_flag("--arrays", arrays, "the drag by solid fraction and cells a diameter alone");
  app.add_option("--json", json, "write the table to this file");
  if (const auto code = protocol::read_command_line(app, "scheme_report", argc, argv)) return *code;

  const auto write = [&json](const nlohmann::json& what) {
    if (!json.empty()) std::ofstream(json) << what.dump(2) << '\n';
    return protocol::kOk;
  };
  if (fractions) return write(fraction_rules());
  if (arrays) return write(array_table());

  const std::vector<double> taus{0.505, 0.6, 1.0, 1.5};
  if (quick) sizes = {10, 20};
  const std::vector<Vec3> offsets{{0.0, 0.0}, {0.5, 0.5}, {0.23, 0.41}};
  struct Job {
    const Row* row;
    int n;
    double tau;
    Vec3 offset;
    double error = 0.0;
  };
  std::vector<Row> rows;
  for (const Row& row : kRows)
    if (row.name.find(filter) != std::string::npos) rows.push_back(row);
  if (rows.empty()) {
    fmt::print(stderr, "scheme_report | error | no row's name has '{}' in it; --list\n", filter);
    return protocol::kBadInput;
  }
  if (names) {
    for (const Row& row : rows) fmt::print("{}\n", row.name);
    return protocol::kOk;
  }
  std::vector<Job> jobs;
  for (const Row& row : rows)
    for (const int n : sizes)
      for (const double tau : taus)
        for (const Vec3& offset : offsets) jobs.push_back({&row, n, tau, offset});
#pragma omp parallel for schedule(dynamic)
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    Job& j = jobs[i];
    j.error = fixed_disc(*j.row, j.n, j.tau, j.offset);
  }
  std::vector<Translation> moving(rows.size());
#pragma omp parallel for schedule(dynamic)
  for (std::size_t i = 0; i < rows.size(); ++i) moving[i] = translating_disc(rows[i], 20, 0.6);

  omp_set_num_threads(1);
  nlohmann::json list = nlohmann::json::array();
  std::size_t job = 0;
  fmt::print("| scheme |");
  for (const int n : sizes)
    for (const double tau : taus) fmt::print(" D{:.0f} τ {} |", 2.0 * radius_of(n), tau);
  fmt::print(" moving: error | σ | peak | cost |\n|---|");
  for (std::size_t i = 0; i < sizes.size() * taus.size() + 4; ++i) fmt::print("---|");
  fmt::print("\n");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    nlohmann::json entry{{"scheme", rows[i].name}, {"fixed", nlohmann::json::array()}};
    fmt::print("| {} |", rows[i].name);
    for (const int n : sizes)
      for (const double tau : taus) {
        double mean = 0.0, lo = 1e9, hi = -1e9;
        for (std::size_t k = 0; k < offsets.size(); ++k, ++job) {
          const double e = 100.0 * jobs[job].error;
          mean += e / static_cast<double>(offsets.size());
          lo = std::min(lo, e);
          hi = std::max(hi, e);
        }
        if (std::isfinite(mean))
          fmt::print(" {:+.2f} ({:.2f}) |", mean, hi - lo);
        else
          fmt::print(" unstable |");
        entry["fixed"].push_back({{"diameter", 2.0 * radius_of(n)},
                                  {"tau", tau},
                                  {"error_percent", mean},
                                  {"spread_percent", hi - lo}});
      }
    const Translation& t = moving[i];
    const double cost = step_seconds(rows[i], true) / step_seconds(rows[i], false);
    fmt::print(" {:+.2f} | {:.2f} | {:.2f} | {:.1f} |\n", 100 * t.error, 100 * t.sigma,
               100 * t.peak, cost);
    entry["moving"] = {{"error_percent", 100 * t.error},
                       {"sigma_percent", 100 * t.sigma},
                       {"peak_percent", 100 * t.peak}};
    entry["cost"] = cost;
    list.push_back(entry);
  }
  list.push_back({{"solid_fraction", fraction_rules()}});
  return write(list);
}
