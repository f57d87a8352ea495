// SPDX-License-Identifier: MIT
/// `trace info FILE` says what a recording holds; `trace diff A B` where two differ first; `trace
/// cut FILE OUT --intervals N` keeps the beginning; `trace plot FILE` draws a particle's way and
/// loads.
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "protocol/program/command_line.h"
#include "protocol/transport/trace_compare.h"

namespace {

using namespace protocol;

int info(const std::string& path) {
  const Trace trace(path);
  const auto record = timeline(trace);
  fmt::print("{}: recorded by the {} program, rank {}, facing {} rank(s), {} frames\n", path,
             trace.recorder(), trace.local_rank(), trace.remote_size(), trace.frames().size());
  for (const Role role : {Role::Fluid, Role::Solid}) {
    const Hello h = trace.hello(role);
    fmt::print("  {:<9} {} {}; step {:.6g} s\n", h.program, h.program_version,
               role == Role::Fluid ? "fluid" : "solid", h.step);
  }
  const Hello fluid = trace.hello(Role::Fluid);
  fmt::print(
      "  box       {:.6g} × {:.6g} m, {}D, interval {:.6g} s = {} fluid step(s) = {} solid\n",
      fluid.box_hi[0] - fluid.box_lo[0], fluid.box_hi[1] - fluid.box_lo[1], fluid.dimension,
      fluid.step * fluid.fluid_steps, fluid.fluid_steps, fluid.solid_steps);
  if (record.empty()) {
    fmt::print("  no interval was exchanged\n");
    return 0;
  }
  std::size_t least = record.front().states.size(), most = least;
  for (const auto& r : record) {
    least = std::min(least, r.states.size());
    most = std::max(most, r.states.size());
  }
  const auto& last = record.back();
  fmt::print(
      "  intervals {} … {}, t = {:.6g} … {:.6g} s, {} … {} particles, {:.3g} s of wall time\n",
      record.front().head.interval, last.head.interval, record.front().head.time, last.head.time,
      least, most, trace.frames().back().wall_clock);
  const auto ending = [&]() -> std::string {
    if (last.head.flags & kLast) return "complete";
    const FrameRow& row = trace.frames().back();
    if (row.kind == Kind::Goodbye) return "solid left: " + decode<Goodbye>(trace.frame(row)).reason;
    if (row.kind == Kind::Fault) return "fault: " + decode<Fault>(trace.frame(row)).reason;
    return "cut off";
  }();
  fmt::print("  ending    {}\n", ending);
  return 0;
}

/// @param tolerance  largest difference that passes, in the scales of `physics` or of the largest
///                   norms
int diff(const std::string& path_a, const std::string& path_b, bool physics, double tolerance) {
  const Trace first(path_a);
  const auto a = timeline(first), b = timeline(Trace(path_b));
  TraceComparison result(physics ? physical_scales(a, first.hello(Role::Fluid)) : largest_norms(a),
                         tolerance);
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    result.states(a[k].head.interval, a[k].states, b[k].states);
    result.loads(a[k].head.interval, a[k].loads, b[k].loads);
  }
  fmt::print("{}\n", result.text());
  if (a.size() != b.size()) fmt::print("lengths differ: {} and {} intervals\n", a.size(), b.size());
  return result.largest() > tolerance || a.size() != b.size() ? 1 : 0;
}

/// The beginning of a recording, as if its run had been told to end there.
int cut(const std::string& path, const std::string& out, std::int64_t intervals) {
  const Trace trace(path);
  std::error_code none;
  if (std::filesystem::equivalent(path, out, none))
    throw std::runtime_error(out + " is the recording itself; give another name for what is kept");
  const std::int64_t first = trace.hello(Role::Fluid).first_interval, last = first + intervals;
  TraceWriter writer(out, trace.recorder(), trace.local_rank(), trace.remote_size());
  bool ends = false;
  for (const FrameRow& row : trace.frames()) {
    if (row.kind == Kind::States && row.interval <= last) {
      auto batch = decode<StateBatch>(trace.frame(row));
      if (row.interval == last) batch.head.flags |= kLast, ends = true;
      writer.record(row.direction, row.remote, encode(batch));
    } else if (row.kind == Kind::Loads && row.interval < last) {
      auto batch = decode<LoadBatch>(trace.frame(row));
      if (row.interval + 1 == last) batch.head.flags |= kStop;
      writer.record(row.direction, row.remote, encode(batch));
    } else if (row.kind == Kind::Hello || row.kind == Kind::Answer) {
      writer.record(row.direction, row.remote, trace.frame(row));
    }
  }
  if (!ends)
    throw std::runtime_error(fmt::format("{} holds fewer than {} intervals", path, intervals));
  fmt::print("{}: intervals {} … {} of {}\n", out, first, last, path);
  return 0;
}

/// tools/trace_plot.py of a checkout (build/PRESET/bin beside tools) or of an installed tree
/// (PREFIX/lib/bplbm/bin beside PREFIX/share/bplbm/tools).
std::string plot_script() {
  const auto root = std::filesystem::canonical("/proc/self/exe") / "../../../..";
  for (const char* tools : {"tools", "share/bplbm/tools"})
    if (const auto script = (root / tools / "trace_plot.py").lexically_normal();
        std::filesystem::exists(script))
      return script.string();
  throw std::runtime_error(
      "trace_plot.py is not beside this program; start it where it was "
      "built or installed");
}

/// Drawing is Python's: the process becomes it.
int plot(const std::string& path, const std::string& out, std::int64_t particle) {
  const Trace trace(path);  // a sentence of ours where it is none
  const std::string id = std::to_string(particle);
  const std::string script = plot_script();
  execl("/usr/bin/python3", "python3", script.c_str(), path.c_str(), out.c_str(), id.c_str(),
        nullptr);
  throw std::runtime_error("/usr/bin/python3 cannot be started; tools/install installs it");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Looks into recorded exchanges"};
  app.require_subcommand(1);
  std::string a, b, picture = "trace.png";
  std::int64_t intervals = 0, particle = 1;
  bool physics = false;
  double tolerance = 0.0;
  auto* cut_command = app.add_subcommand("cut", "keep the beginning of a recording");
  cut_command->add_option("file", a)->required();
  cut_command->add_option("out", b, "the new recording")->required();
  cut_command->add_option("--intervals", intervals, "how many")
      ->required()
      ->check(CLI::PositiveNumber);
  auto* plot_command = app.add_subcommand("plot", "draw a particle's way, velocity and load");
  plot_command->add_option("file", a)->required();
  plot_command->add_option("--out", picture, "the picture")->capture_default_str();
  plot_command->add_option("--particle", particle, "its id")->capture_default_str();
  auto* info_command = app.add_subcommand("info", "what a recording holds");
  info_command->add_option("file", a)->required();
  auto* diff_command = app.add_subcommand("diff", "the first difference of two recordings");
  diff_command->add_option("a", a)->required();
  diff_command->add_option("b", b)->required();
  diff_command->add_flag("--physics", physics,
                         "measure places in radii, loads in weights; else in the largest of all");
  diff_command->add_option("--tolerance", tolerance, "largest difference that passes")
      ->check(finite_number(0.0, true));
  if (const auto code = read_command_line(app, "trace", argc, argv)) return *code;
  try {
    if (cut_command->parsed()) return cut(a, b, intervals);
    if (plot_command->parsed()) return plot(a, picture, particle);
    return info_command->parsed() ? info(a) : diff(a, b, physics, tolerance);
  } catch (const std::exception& error) {
    std::fflush(stdout);
    fmt::print(stderr, "trace | error | {}\n", error.what());
    return 2;
  }
}
