// SPDX-License-Identifier: MIT
/// `trace info FILE` says what a recording holds; `trace diff A B` where two differ first.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "protocol/trace_compare.h"

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

int diff(const std::string& path_a, const std::string& path_b) {
  const auto a = timeline(Trace(path_a)), b = timeline(Trace(path_b));
  TraceComparison result(a);
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    result.states(a[k].head.interval, a[k].states, b[k].states);
    result.loads(a[k].head.interval, a[k].loads, b[k].loads);
  }
  fmt::print("{}\n", result.text());
  if (a.size() != b.size()) fmt::print("lengths differ: {} and {} intervals\n", a.size(), b.size());
  return result.first() || a.size() != b.size() ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Looks into recorded exchanges"};
  app.require_subcommand(1);
  std::string a, b;
  auto* info_command = app.add_subcommand("info", "what a recording holds");
  info_command->add_option("file", a)->required();
  auto* diff_command = app.add_subcommand("diff", "the first difference of two recordings");
  diff_command->add_option("a", a)->required();
  diff_command->add_option("b", b)->required();
  CLI11_PARSE(app, argc, argv);
  try {
    return info_command->parsed() ? info(a) : diff(a, b);
  } catch (const std::exception& error) {
    std::fflush(stdout);
    fmt::print(stderr, "trace | error | {}\n", error.what());
    return 2;
  }
}
