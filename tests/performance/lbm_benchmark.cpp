// SPDX-License-Identifier: GPL-2.0-or-later
/// `lbm_benchmark [--filter TEXT] [--json FILE]`: speed of every kernel row as ratios in one run:
/// against the bandwidth of the machine (roof), against pure fluid, against the naive AoS code.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <omp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "lbm_solver/immersed/boundary_trace.h"
#include "lbm_solver/solver/fluid.h"
#include "lbm_solver/viscosity/relaxation_table.h"
#include "protocol/program/command_line.h"
#include "tests/performance/aos_baseline.h"

namespace {

using namespace lbm;

/// One line of the result.
struct Entry {
  std::string name;
  CollisionOperator collision = CollisionOperator::Trt;
  int grid = 0, threads = 1;
  double covered = 0.0, mlups = 0.0;
  bool moving = false;      ///< the bodies are placed anew in each step
  bool one_by_one = false;  ///< a parallel region a step instead of one for all
  VelocitySet lattice = VelocitySet::D2Q9;
  Precision precision = Precision::Double;
};

Domain box(const Entry& e) {
  const int n = e.grid;
  if (lattice(e.lattice).D == 2) return {n, n, Side::Periodic, Side::Periodic};
  return {n, n, Side::Periodic, Side::Periodic, n, Side::Periodic};
}

double cells(const Entry& e) {
  return std::pow(static_cast<double>(e.grid), lattice(e.lattice).D);
}

/// Bytes that an update must move.
double bytes(const Entry& e) {
  return 2.0 * lattice(e.lattice).Q * (e.precision == Precision::Double ? 8.0 : 4.0);
}

/// Discs or spheres of ten cells on a square or cubic lattice, moving slowly, that cover a part of
/// the box.
std::vector<Body> packing(const Entry& e) {
  std::vector<Body> bodies;
  if (e.covered <= 0.0) return bodies;
  const bool flat = lattice(e.lattice).D == 2;
  constexpr double pi = 3.14159265358979;
  const double volume = flat ? 25.0 * pi : 4.0 / 3.0 * 125.0 * pi;
  const double spacing = std::pow(volume / e.covered, flat ? 0.5 : 1.0 / 3.0);
  const int count = static_cast<int>(std::lround(e.grid / spacing)), layers = flat ? 1 : count;
  const auto at = [&](int i) { return (i + 0.5) * e.grid / count; };
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j < count; ++j)
      for (int i = 0; i < count; ++i)
        bodies.push_back({static_cast<std::int64_t>(bodies.size() + 1),
                          {at(i), at(j) + 0.3, flat ? 0.0 : at(k) + 0.17},
                          5.0,
                          {0.01, 0.0}});
  return bodies;
}

void stir(Fluid& fluid) {
  const Domain& d = fluid.domain();
  for (int z = 0; z < d.nz; ++z)
    for (int y = 0; y < d.ny; ++y)
      for (int x = 0; x < d.nx; ++x)
        fluid.set_equilibrium({x, y, z}, 1.0,
                              {0.02 * std::sin(0.01 * y), 0.02 * std::cos(0.013 * x)});
}

int steps_for(const Entry& e) {
  return std::max(2, static_cast<int>(4e6 / cells(e)));
}

void kernel_benchmark(benchmark::State& state, const Entry& e, KernelChoice choice) {
  omp_set_num_threads(e.threads);
  choice.parameters.tau = 0.8;
  choice.lattice = e.lattice;
  choice.precision = e.precision;
  Fluid fluid(box(e), choice);
  stir(fluid);
  std::vector<Body> bodies = packing(e);
  if (choice.solid_term != SolidTerm::None) fluid.place(bodies);
  const int steps = steps_for(e);
  const bool together = e.covered == 0.0 && !e.one_by_one;
  for (auto _ : state) {
    if (together) fluid.advance(steps);
    for (int s = 0; s < (together ? 0 : steps); ++s) {
      if (e.moving) {
        for (Body& b : bodies) b.centre += b.velocity;
        fluid.place(bodies);
      }
      fluid.step();
      if (e.covered > 0.0) benchmark::DoNotOptimize(fluid.loads());
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * steps * cells(e)));
}

template <class L>
void aos_steps(benchmark::State& state, const Entry& e) {
  test::AosLattice<L> lattice(box(e).cells(), 0.8);
  const int steps = std::max(1, steps_for(e) / 4);
  for (auto _ : state)
    for (int s = 0; s < steps; ++s) lattice.step();
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * steps * cells(e)));
}

void aos_benchmark(benchmark::State& state, const Entry& e) {
  if (e.lattice == VelocitySet::D2Q9) aos_steps<D2Q9>(state, e);
  if (e.lattice == VelocitySet::D3Q19) aos_steps<D3Q19>(state, e);
  if (e.lattice == VelocitySet::D3Q27) aos_steps<D3Q27>(state, e);
}

/// One part of a particle's cost, for 49 and for 10 000 discs of ten cells: items are particles.
void particle_benchmark(benchmark::State& state, int count, const std::string& part) {
  omp_set_num_threads(1);
  const int side = static_cast<int>(std::round(std::sqrt(count))), n = 16 * side;
  CoverMap cover({n, n, Side::Periodic, Side::Periodic});
  std::vector<Body> discs;
  for (int i = 0; i < count; ++i)
    discs.push_back(
        {i, {8.0 + 16.0 * (i % side), 8.3 + 16.0 * (i / side)}, 5.0, {2e-2, 0.0}, 1e-4});
  cover.update(discs);
  for (auto _ : state) {
    if (part == "map")
      for (Body& d : discs) d.centre += d.velocity;
    if (part == "velocity")
      for (Body& d : discs) d.spin.z() += 1e-9;
    if (part == "loads")
      benchmark::DoNotOptimize(cover.loads());
    else if (part == "trace")
      for (const Body& d : discs) benchmark::DoNotOptimize(trace_boundary(d.centre, d.radius));
    else
      cover.update(discs);
  }
  state.SetItemsProcessed(state.iterations() * count);
}

/// One array after the other, so that each thread follows a single stream.
template <class Real>
void touch_rows(Populations& f) {
  const int rows = f.ny() * f.nz();
#pragma omp parallel
  for (int q = 0; q < f.lattice().Q; ++q) {
#pragma omp for schedule(static) nowait
    for (int r = 0; r < rows; ++r) {
      Real* row = f.row<Real>(q, r % f.ny(), r / f.ny());
      for (int x = 0; x < f.nx(); ++x) row[x] = row[x] * Real(1.0000001);
    }
  }
}

/// Updates all arrays in place, as a sweep does without any arithmetic: items are lattice updates.
void bandwidth_benchmark(benchmark::State& state, const Entry& e) {
  omp_set_num_threads(e.threads);
  Populations f(lattice(e.lattice), box(e).cells(), e.precision);
  for (auto _ : state) {
    if (e.precision == Precision::Double)
      touch_rows<double>(f);
    else
      touch_rows<float>(f);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * cells(e)));
}

/// Keeps the medians of the repetitions and prints nothing.
class Collector final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Aggregate && run.aggregate_name == "median")
        rate[run.run_name.function_name] = run.counters.at("items_per_second");
  }
  std::map<std::string, double> rate;
};

std::vector<Entry> entries;

template <class Function>
void add(const Entry& e, Function&& run) {
  entries.push_back(e);
  benchmark::RegisterBenchmark(e.name.c_str(), run)->Repetitions(7)->MinTime(0.15)->UseRealTime();
}

/// What an entry runs on.
struct Setting {
  VelocitySet lattice;
  Precision precision;
  int grid;

  Entry entry(const std::string& what, int threads = 1) const {
    Entry e;
    e.name = label(what, threads);
    e.grid = grid;
    e.threads = threads;
    e.lattice = lattice;
    e.precision = precision;
    return e;
  }
  std::string label(const std::string& what, int threads = 1) const {
    return fmt::format("{} {} {} {} {}t", name_of(lattice), name_of(precision), what, grid,
                       threads);
  }
};

void add_kernel(Entry e, const KernelChoice& choice) {
  e.collision = choice.collision;
  add(e, [=](benchmark::State& s) { kernel_benchmark(s, e, choice); });
}

/// A viscosity that falls with the root of the shear rate, within bounds.
std::shared_ptr<const RelaxationTable> gel() {
  return std::make_shared<RelaxationTable>([](double shear_rate) {
    return 0.5 + 3.0 * std::clamp(3e-3 / std::sqrt(shear_rate), 1e-3, 3.0);
  });
}

void register_setting(const Setting& on, int threads) {
  for (int t = 1; t <= threads; ++t) {
    const Entry bandwidth = on.entry("bandwidth", t);
    add(bandwidth, [=](benchmark::State& s) { bandwidth_benchmark(s, bandwidth); });
    Entry one_by_one = on.entry("trt one by one", t);
    one_by_one.one_by_one = true;
    add_kernel(one_by_one, {});
    for (const CollisionOperator collision : choices<CollisionOperator>())
      if (on.precision == Precision::Double || collision != CollisionOperator::RecursiveRegularised)
        add_kernel(on.entry(name_of(collision), t), {.collision = collision});
  }
  for (const auto collision : {CollisionOperator::Bgk, CollisionOperator::Trt}) {
    add_kernel(on.entry(name_of(collision) + "+les"),
               {.collision = collision, .parameters = {.smagorinsky = 0.1}});
    add_kernel(on.entry(name_of(collision) + "+gel"),
               {.collision = collision, .parameters = {.viscosity_table = gel()}});
  }
  add_kernel(on.entry("trt+force"), {.force = true, .parameters = {.force_x = 1e-7}});
  const KernelChoice solids{.solid_term = SolidTerm::LayeredResistance};
  const KernelChoice linear{.solid_term = SolidTerm::LayeredHoldych};
  for (const double covered : {0.0, 0.1, 0.15, 0.4})
    for (const bool moving : {false, true}) {
      if (covered == 0.0 && moving) continue;
      const char* what = moving ? "coupled" : "covered";
      Entry e = on.entry(fmt::format("trt {} {:.0f} %", what, 100 * covered));
      e.covered = covered;
      e.moving = moving;
      add_kernel(e, solids);
      if (covered == 0.0) continue;
      Entry other = on.entry(fmt::format("trt {} {:.0f} %, Holdych", what, 100 * covered));
      other.covered = covered;
      other.moving = moving;
      add_kernel(other, linear);
    }
  const Entry aos = on.entry("AoS two lattices");
  if (on.precision == Precision::Double)
    add(aos, [=](benchmark::State& s) { aos_benchmark(s, aos); });
}

double rate_of(const Collector& c, const std::string& name) {
  const auto found = c.rate.find(name);
  return found == c.rate.end() ? std::nan("") : found->second;
}

/// @return  what is wrong with it, as CLI11 wants to hear it
std::string is_regular_expression(const std::string& text) try {
  const std::regex compiled(text);
  return {};
} catch (const std::regex_error& error) {
  return error.what();
}

nlohmann::json report(const Collector& c) {
  nlohmann::json list = nlohmann::json::array();
  fmt::print("{:42} {:>8} {:>6} {:>8} {:>12}\n", "kernel", "MLUPS", "roof", "vs_pure",
             "vs_baseline");
  for (const Entry& e : entries) {
    const double rate = rate_of(c, e.name);
    if (std::isnan(rate)) continue;
    if (e.grid == 0) {
      fmt::print("{:42} {:>8.0f} ns a particle\n", e.name, 1e9 / rate);
      list.push_back({{"name", e.name}, {"nanoseconds_a_particle", 1e9 / rate}});
      continue;
    }
    const Setting on{e.lattice, e.precision, e.grid};
    const double roof = rate / rate_of(c, on.label("bandwidth", e.threads));
    const double pure = rate / rate_of(c, on.label("trt", e.threads));
    const Setting in_double{e.lattice, Precision::Double, e.grid};
    const double baseline = rate / rate_of(c, in_double.label("AoS two lattices"));
    fmt::print("{:42} {:>8.0f} {:>6.2f} {:>8.2f} {:>12.1f}\n", e.name, rate * 1e-6, roof, pure,
               baseline);
    list.push_back({{"name", e.name},
                    {"lattice", name_of(e.lattice)},
                    {"collision", name_of(e.collision)},
                    {"precision", name_of(e.precision)},
                    {"grid", e.grid},
                    {"threads", e.threads},
                    {"covered", e.covered},
                    {"mlups", rate * 1e-6},
                    {"roof", roof},
                    {"vs_pure", pure},
                    {"vs_baseline", baseline},
                    {"gigabytes_per_second", rate * bytes(e) * 1e-9}});
  }
  return list;
}

}  // namespace

int main(int argc, char** argv) {
  std::string filter = ".", json;
  int threads = 2;
  bool names = false;
  std::vector<int> grids;
  std::vector<std::string> sets, lattices{"D2Q9"}, precisions{"double"};
  for (const VelocitySet set : choices<VelocitySet>()) sets.push_back(name_of(set));
  CLI::App app{"Speed of every kernel, as ratios in one run"};
  app.add_option("--filter", filter,
                 "regular expression on the names; bandwidth is always measured")
      ->check(is_regular_expression);
  app.add_flag("--list", names, "the kernels' names, and nothing else");
  app.add_option("--json", json, "write the table to this file");
  app.add_option("--threads", threads, "largest number of threads");
  app.add_option("--grid", grids, "cells along a side (else 200 and 1600, in 3D 32 and 160)");
  app.add_option("--lattice", lattices, "D2Q9, D3Q19, D3Q27")->check(CLI::IsMember(sets));
  app.add_option("--precision", precisions, "double, single")
      ->check(CLI::IsMember({"double", "single"}));
  if (const auto code = protocol::read_command_line(app, "lbm_benchmark", argc, argv)) return *code;
  for (const std::string& set : lattices)
    for (const std::string& precision : precisions) {
      const auto velocities = from_name<VelocitySet>(set);
      const bool flat = lattice(velocities).D == 2;
      const auto sizes = !grids.empty() ? grids : std::vector{flat ? 200 : 32, flat ? 1600 : 160};
      for (const int grid : sizes)
        register_setting({velocities, from_name<Precision>(precision), grid}, threads);
    }
  for (const int count : {49, 10000})
    for (const char* part : {"map", "velocity", "loads", "trace"})
      add({fmt::format("particles {} {}", count, part)},
          [=](benchmark::State& s) { particle_benchmark(s, count, part); });

  const std::regex wanted(filter);
  if (std::ranges::none_of(entries, [&](const Entry& e) { return regex_search(e.name, wanted); })) {
    fmt::print(stderr, "lbm_benchmark | error | no kernel's name has '{}' in it; --list\n", filter);
    return protocol::kBadInput;
  }
  if (names) {
    for (const Entry& e : entries)
      if (regex_search(e.name, wanted)) fmt::print("{}\n", e.name);
    return protocol::kOk;
  }
  std::vector<std::string> words{argv[0], "--benchmark_enable_random_interleaving=true",
                                 "--benchmark_filter=bandwidth|" + filter};
  std::vector<char*> arguments;
  for (auto& w : words) arguments.push_back(w.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector);
  const auto list = report(collector);
  if (!json.empty()) std::ofstream(json) << list.dump(2) << '\n';
  return 0;
}
