// SPDX-License-Identifier: GPL-2.0-or-later
/// `lbm_benchmark [--filter TEXT] [--json FILE]`: speed of every kernel row as ratios in one run:
/// against the bandwidth of the machine (roof), against pure fluid, against the naive AoS code.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <omp.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "lbm_solver/immersed/boundary_trace.h"
#include "lbm_solver/solver/fluid.h"
#include "tests/performance/aos_baseline.h"

namespace {

using namespace lbm;

constexpr double kBytes = 2.0 * D2Q9::Q * sizeof(double);  // that an update must move

/// One line of the result.
struct Entry {
  std::string name, collision;
  int grid = 0, threads = 1;
  double covered = 0.0, mlups = 0.0;
  bool moving = false;      ///< the discs are placed anew in each step
  bool one_by_one = false;  ///< a parallel region a step instead of one for all
};

/// Discs of ten cells on a square lattice, moving slowly, that cover a part of the grid.
std::vector<Disc> packing(int n, double covered) {
  std::vector<Disc> discs;
  if (covered <= 0.0) return discs;
  const double spacing = std::sqrt(25.0 * 3.14159265 / covered);
  const int count = static_cast<int>(n / spacing);
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < count; ++i)
      discs.push_back({static_cast<std::int64_t>(discs.size() + 1),
                       {(i + 0.5) * n / count, (j + 0.5) * n / count + 0.3},
                       5.0,
                       {0.01, 0.0},
                       0.0});
  return discs;
}

void stir(Fluid& fluid) {
  const Domain& d = fluid.domain();
  for (int y = 0; y < d.ny; ++y)
    for (int x = 0; x < d.nx; ++x)
      fluid.set_equilibrium(x, y, 1.0, {0.02 * std::sin(0.01 * y), 0.02 * std::cos(0.013 * x)});
}

int steps_for(int n) {
  return std::max(2, static_cast<int>(4e6 / (static_cast<double>(n) * n)));
}

void kernel_benchmark(benchmark::State& state, const Entry& e, KernelChoice choice) {
  omp_set_num_threads(e.threads);
  choice.parameters.tau = 0.8;
  Fluid fluid({e.grid, e.grid, Side::Periodic, Side::Periodic}, choice);
  stir(fluid);
  std::vector<Disc> discs = packing(e.grid, e.covered);
  if (choice.solid_term != "none") fluid.place(discs);
  const int steps = steps_for(e.grid);
  const bool together = e.covered == 0.0 && !e.one_by_one;
  for (auto _ : state) {
    if (together) fluid.advance(steps);
    for (int s = 0; s < (together ? 0 : steps); ++s) {
      if (e.moving) {
        for (Disc& d : discs) d.centre += d.velocity;
        fluid.place(discs);
      }
      fluid.step();
      if (e.covered > 0.0) benchmark::DoNotOptimize(fluid.loads());
    }
  }
  state.SetItemsProcessed(state.iterations() * steps * e.grid * e.grid);
}

void aos_benchmark(benchmark::State& state, const Entry& e) {
  test::AosLattice lattice(e.grid, e.grid, 0.8);
  const int steps = steps_for(e.grid);
  for (auto _ : state)
    for (int s = 0; s < steps; ++s) lattice.step();
  state.SetItemsProcessed(state.iterations() * steps * e.grid * e.grid);
}

/// One part of a particle's cost, for 49 and for 10 000 discs of ten cells: items are particles.
void particle_benchmark(benchmark::State& state, int count, const std::string& part) {
  omp_set_num_threads(1);
  const int side = static_cast<int>(std::round(std::sqrt(count))), n = 16 * side;
  CoverMap cover({n, n, Side::Periodic, Side::Periodic}, {WeightRule::Viscous, 0.8});
  std::vector<Disc> discs;
  for (int i = 0; i < count; ++i)
    discs.push_back(
        {i, {8.0 + 16.0 * (i % side), 8.3 + 16.0 * (i / side)}, 5.0, {2e-2, 0.0}, 1e-4});
  cover.update(discs);
  for (auto _ : state) {
    if (part == "map")
      for (Disc& d : discs) d.centre += d.velocity;
    if (part == "velocity")
      for (Disc& d : discs) d.spin += 1e-9;
    if (part == "loads")
      benchmark::DoNotOptimize(cover.loads());
    else if (part == "trace")
      for (const Disc& d : discs) benchmark::DoNotOptimize(trace_boundary(d.centre, d.radius));
    else
      cover.update(discs);
  }
  state.SetItemsProcessed(state.iterations() * count);
}

/// Updates nine arrays in place, as a sweep does without any arithmetic: items are lattice updates.
void bandwidth_benchmark(benchmark::State& state, const Entry& e) {
  omp_set_num_threads(e.threads);
  Populations f(e.grid, e.grid);
  for (auto _ : state) {
#pragma omp parallel for schedule(static)
    for (int y = 0; y < e.grid; ++y)
      for (int q = 0; q < D2Q9::Q; ++q) {
        double* row = f.row(q, y);
        for (int x = 0; x < e.grid; ++x) row[x] = row[x] * 1.0000001;
      }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * e.grid * e.grid);
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

std::string label(const std::string& what, int grid, int threads) {
  return fmt::format("{} {}² {}t", what, grid, threads);
}

void register_all(const std::vector<int>& grids, int threads) {
  for (const int n : grids) {
    for (int t = 1; t <= threads; ++t) {
      const Entry bandwidth{label("bandwidth", n, t), "", n, t};
      add(bandwidth, [=](benchmark::State& s) { bandwidth_benchmark(s, bandwidth); });
      const Entry steps{label("trt one by one", n, t), "trt", n, t, 0.0, 0.0, false, true};
      add(steps, [=](benchmark::State& s) { kernel_benchmark(s, steps, {.collision = "trt"}); });
      for (const std::string& collision : known_collisions()) {
        const Entry pure{label(collision, n, t), collision, n, t};
        add(pure,
            [=](benchmark::State& s) { kernel_benchmark(s, pure, {.collision = collision}); });
      }
    }
    for (const char* collision : {"bgk", "trt"}) {
      const Entry les{label(std::string(collision) + "+les", n, 1), collision, n, 1};
      add(les, [=](benchmark::State& s) {
        kernel_benchmark(s, les,
                         {.collision = collision,
                          .turbulence = "smagorinsky",
                          .parameters = {.smagorinsky = 0.1}});
      });
    }
    const Entry force{label("trt+force", n, 1), "trt", n, 1};
    add(force, [=](benchmark::State& s) {
      kernel_benchmark(s, force,
                       {.collision = "trt", .force = true, .parameters = {.force_x = 1e-7}});
    });
    for (const double covered : {0.0, 0.1, 0.4}) {
      const Entry e{label(fmt::format("trt covered {:.0f} %", 100 * covered), n, 1), "trt", n, 1,
                    covered};
      add(e, [=](benchmark::State& s) {
        kernel_benchmark(s, e, {.collision = "trt", .solid_term = "layered_holdych"});
      });
    }
    for (const double covered : {0.1, 0.4}) {
      const Entry e{label(fmt::format("trt coupled {:.0f} %", 100 * covered), n, 1),
                    "trt",
                    n,
                    1,
                    covered,
                    0.0,
                    true};
      add(e, [=](benchmark::State& s) {
        kernel_benchmark(s, e, {.collision = "trt", .solid_term = "layered_holdych"});
      });
    }
    const Entry aos{label("AoS two lattices", n, 1), "trt", n, 1};
    add(aos, [=](benchmark::State& s) { aos_benchmark(s, aos); });
  }
}

double rate_of(const Collector& c, const std::string& name) {
  const auto found = c.rate.find(name);
  return found == c.rate.end() ? std::nan("") : found->second;
}

nlohmann::json report(const Collector& c) {
  nlohmann::json list = nlohmann::json::array();
  fmt::print("{:32} {:>8} {:>6} {:>8} {:>12}\n", "kernel", "MLUPS", "roof", "vs_pure",
             "vs_baseline");
  for (const Entry& e : entries) {
    const double rate = rate_of(c, e.name);
    if (std::isnan(rate)) continue;
    if (e.grid == 0) {
      fmt::print("{:32} {:>8.0f} ns a particle\n", e.name, 1e9 / rate);
      list.push_back({{"name", e.name}, {"nanoseconds_a_particle", 1e9 / rate}});
      continue;
    }
    const double roof = rate / rate_of(c, label("bandwidth", e.grid, e.threads));
    const double pure = rate / rate_of(c, label("trt", e.grid, e.threads));
    const double baseline = rate / rate_of(c, label("AoS two lattices", e.grid, 1));
    fmt::print("{:32} {:>8.0f} {:>6.2f} {:>8.2f} {:>12.1f}\n", e.name, rate * 1e-6, roof, pure,
               baseline);
    list.push_back({{"name", e.name},
                    {"lattice", "D2Q9"},
                    {"collision", e.collision},
                    {"precision", "double"},
                    {"grid", e.grid},
                    {"threads", e.threads},
                    {"covered", e.covered},
                    {"mlups", rate * 1e-6},
                    {"roof", roof},
                    {"vs_pure", pure},
                    {"vs_baseline", baseline},
                    {"gigabytes_per_second", rate * kBytes * 1e-9}});
  }
  return list;
}

}  // namespace

int main(int argc, char** argv) {
  std::string filter = ".", json;
  int threads = 2;
  std::vector<int> grids{200, 1600};
  CLI::App app{"Speed of every kernel, as ratios in one run"};
  app.add_option("--filter", filter,
                 "regular expression on the names; bandwidth is always measured");
  app.add_option("--json", json, "write the table to this file");
  app.add_option("--threads", threads, "largest number of threads");
  app.add_option("--grid", grids, "cells along a side");
  CLI11_PARSE(app, argc, argv);
  register_all(grids, threads);
  for (const int count : {49, 10000})
    for (const char* part : {"map", "velocity", "loads", "trace"})
      add({fmt::format("particles {} {}", count, part)},
          [=](benchmark::State& s) { particle_benchmark(s, count, part); });

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
