// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>

#include "lbm_solver/immersed/solid_term.h"
#include "lbm_solver/solver/viscosity_plan.h"
#include "lbm_solver/viscosity/viscosity_law.h"

namespace lbm {
namespace {

const char* text(SideKind s) {
  return s == SideKind::Wall ? "wall" : "periodic";
}

const char* buoyancy_text(protocol::Buoyancy b) {
  switch (b) {
    case protocol::Buoyancy::ByFluid:
      return "added to the load by the fluid";
    case protocol::Buoyancy::BySolid:
      return "added by the solid";
    case protocol::Buoyancy::None:
      break;
  }
  return "off";
}

/// Seconds a fluid step takes, by doing some for a tenth of a second.
double measure_step(Fluid& fluid, const std::vector<Body>& bodies) {
  using Clock = std::chrono::steady_clock;
  const auto step = [&] {
    if (!bodies.empty()) fluid.place(bodies);
    fluid.step();
    if (!bodies.empty()) fluid.loads();
  };
  step();
  const auto start = Clock::now();
  int steps = 0;
  double seconds = 0.0;
  for (; seconds < 0.1; ++steps) {
    step();
    seconds = std::chrono::duration<double>(Clock::now() - start).count();
  }
  return seconds / steps;
}

const char* weight_text(const KernelChoice& kernel) {
  if (by_resistance(kernel.solid_term)) return "";  // has none
  switch (kernel.weight) {
    case WeightRule::Viscous:
      return " with B(ε,τ)";
    case WeightRule::Balanced:
      return " with balanced B(ε,τ)";
    case WeightRule::Fraction:
      break;
  }
  return " with B = ε";
}

std::string boundary_text(const Scene& s) {
  int velocity = 0, pressure = 0, outflow = 0;
  for (const auto& b : s.boundaries) {
    velocity += b.kind == BoundaryScene::Kind::Velocity;
    pressure += b.kind == BoundaryScene::Kind::Pressure;
    outflow += b.kind == BoundaryScene::Kind::Outflow;
  }
  return fmt::format("{} velocity, {} pressure, {} outflow", velocity, pressure, outflow);
}

/// What a hydraulic ratio does; empty where all particles have 1.
std::string hydraulic_text(const ParticleScene& particles, double dx, bool flat) {
  const std::vector<double>& ratios = particles.hydraulic_ratio;
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  if (*least == 1.0) return {};
  const double lo = *least * particles.diameter.lo, hi = *most * particles.diameter.hi;
  return fmt::format(
      "ratio {:.6g}{}: the flow sees {} of D {:.6g} … {:.6g} m, D/Δx {:.4g}; weight, buoyancy and "
      "contacts are those of the whole {}",
      fmt::join(ratios, ", "), ratios.size() > 1 ? " by type" : "", flat ? "discs" : "spheres", lo,
      hi, lo / dx, flat ? "discs" : "spheres");
}

/// What a mesh or an image is; empty for other obstacles.
std::string shape_text(const ObstacleScene& o, double dx) {
  if (o.mesh) {
    const auto [low, high] = bounds(*o.mesh->surface);
    const Vec3 size = high - low;
    return fmt::format(
        "mesh {}: {} triangles, {:.4g} × {:.4g} × {:.4g} m = {:.3g} × {:.3g} × {:.3g} cells, {} "
        "{:.4g} m³{}",
        o.mesh->file, o.mesh->surface->triangles.size(), size.x(), size.y(), size.z(),
        size.x() / dx, size.y() / dx, size.z() / dx,
        o.mesh->hollow ? "solid outside of" : "encloses", o.mesh->volume,
        o.mesh->thickness > 0.0 ? fmt::format(", {:.3g} cells thick", o.mesh->thickness / dx) : "");
  }
  if (!o.image) return {};
  const auto& [size, solid] = *o.image->voxels;
  const double sum = std::accumulate(solid.begin(), solid.end(), 0.0);
  return fmt::format("image {}: {} × {} × {} voxels of {:.4g} m, {:.3g} cells each, {:.4g} solid",
                     o.image->file, size[0], size[1], size[2], o.image->voxel, o.image->voxel / dx,
                     sum / static_cast<double>(solid.size()));
}

}  // namespace

std::string describe_choices() {
  std::string out;
  const auto line = [&out](const char* key, const std::vector<std::string>& names) {
    out += fmt::format("{:<21} {}\n", key, fmt::join(names, ", "));
  };
  line("numerics.lattice", names_of(choices<VelocitySet>()));
  line("numerics.collision", names_of(choices<CollisionOperator>()));
  line("numerics.solid_term", names_of(choices<SolidTerm>()));
  line("numerics.scheme", names_of(choices<SolidScheme>()));
  line("fluid.viscosity.model", names_of(known_viscosities()));
  return out + "or \"auto\"; lbm_solver/docs/scene.md has every key of a scene\n";
}

namespace {

/// Lines of a report, each under a name.
class Report {
 public:
  explicit Report(std::string title) : text_(std::move(title)) {}
  void line(const char* name, const std::string& value) {
    text_ += fmt::format("{:<12} {}\n", name, value);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void report_box(const Scene& s, const Plan& p, Report& report) {
  const std::string sides =
      fmt::format("sides x {}, y {}", text(s.box.sides[0]), text(s.box.sides[1]));
  const std::string precision = p.kernel.precision == Precision::Single ? ", single precision" : "";
  if (s.box.dimension == 2) {
    report.line("box", fmt::format("{:.6g} × {:.6g} m, depth {:.6g} m, {}", s.box.size.x(),
                                   s.box.size.y(), s.box.depth, sides));
    report.line("grid", fmt::format("{} × {} cells of {:.6g} m{}", p.domain.nx, p.domain.ny,
                                    p.units.dx, precision));
  } else {
    report.line("box", fmt::format("{:.6g} × {:.6g} × {:.6g} m, {}, z {}", s.box.size.x(),
                                   s.box.size.y(), s.box.size.z(), sides, text(s.box.sides[2])));
    report.line("grid",
                fmt::format("{} × {} × {} cells of {:.6g} m, {}{}", p.domain.nx, p.domain.ny,
                            p.domain.nz, p.units.dx, name_of(p.kernel.lattice), precision));
  }
}

void report_fluid(const Scene& s, const Plan& p, Report& report) {
  report.line("fluid step", fmt::format("Δt = {:.6g} s, C = Δx/Δt = {:.6g} m/s [{}]", p.units.dt,
                                        p.lattice_speed, p.step_limit));
  report.line("fluid", fmt::format("ρ {:.6g} kg/m³, ν {:.6g} m²/s, τ = {:.6g}", s.fluid.density,
                                   s.fluid.viscosity, p.kernel.parameters.tau));
  for (const std::string& text : describe_viscosity(s, p)) report.line("viscosity", text);
  report.line(
      "numbers",
      fmt::format("Re = u L/ν {:.4g} with L = {:.4g} m of {}{}, Re_h = u Δx/ν {:.3g}, Ma = u/c_s "
                  "{:.3g}, u/C {:.3g} at u = {:.4g} m/s",
                  p.reynolds, p.reynolds_length, p.reynolds_of,
                  p.kernel.parameters.viscosity_table ? " and ν at the typical shear rate" : "",
                  p.reynolds_cell, p.u_over_c * std::numbers::sqrt3, p.u_over_c,
                  s.fluid.velocity_scale));
}

void report_solids(const Scene& s, const Plan& p, Report& report) {
  if (s.particles)
    report.line(
        "particles",
        fmt::format("D {:.6g} … {:.6g} m, D/Δx {:.4g}, ρ {:.6g} … {:.6g} kg/m³",
                    s.particles->diameter.lo, s.particles->diameter.hi, p.cells_per_diameter,
                    s.particles->density.lo, s.particles->density.hi));
  if (s.particles && s.coupling) {
    const std::string text = hydraulic_text(*s.particles, p.units.dx, s.box.dimension == 2);
    if (!text.empty()) report.line("hydraulic", text);
  }
  for (std::size_t i = 0; i < s.obstacles.size(); ++i) {
    const std::string text = shape_text(s.obstacles[i], p.units.dx);
    if (!text.empty()) report.line("obstacle", fmt::format("{}. {}", i + 1, text));
  }
  if (s.coupling)
    report.line("coupling",
                fmt::format("interval {:.6g} s = {} fluid step(s) = {} solid steps of {:.4g} s "
                            "[{}]",
                            p.interval(), p.fluid_steps, p.substeps, p.interval() / p.substeps,
                            p.substep_limit));
}

/// What was chosen, and why.
void report_choices(const Plan& p, Report& report) {
  if (!p.collision_reason.empty())
    report.line("collision",
                fmt::format("{} [{}]", name_of(p.kernel.collision), p.collision_reason));
  if (!p.solid_reason.empty())
    report.line("solids", fmt::format("{}, {} [{}]", name_of(p.scheme),
                                      name_of(p.kernel.solid_term), p.solid_reason));
  if (!p.expected_error.empty()) report.line("error", p.expected_error);
}

}  // namespace

std::string describe(const Scene& s, const Plan& p) {
  Report report(fmt::format("scene        {} ({})\n", s.title, s.file));
  report_box(s, p, report);
  report_fluid(s, p, report);
  report_solids(s, p, report);
  report_choices(p, report);
  report.line("duration", fmt::format("{:.6g} s = {} intervals", s.end_time, p.intervals));
  for (const std::string& w : p.warnings) report.line("warning", w);
  return report.text();
}

namespace {

/// The parts of a fluid by what they are called, those that a scene has and those that it lacks.
class Parts {
 public:
  explicit Parts(std::string always) : on_(std::move(always)) {}
  void add(bool used, const std::string& text, const std::string& absent) {
    std::string& list = used ? on_ : off_;
    list += (list.empty() ? "" : ", ") + (used ? text : absent);
  }
  void add(bool used, const std::string& text) { add(used, text, text); }
  const std::string& on() const { return on_; }
  const std::string& off() const { return off_; }

 private:
  std::string on_, off_;
};

void add_fluid_parts(const Scene& s, const Plan& p, Parts& parts) {
  const bool walls = std::any_of(s.box.sides.begin(), s.box.sides.begin() + s.box.dimension,
                                 [](SideKind k) { return k == SideKind::Wall; });
  parts.add(walls, "half-way walls", "walls");
  parts.add(!s.boundaries.empty(), "boundaries: " + boundary_text(s), "inlets and outlets");
  parts.add(s.box.pressure_jump.norm() > 0.0, "pressure jump");
  parts.add(p.kernel.force, "body force");
  parts.add(p.kernel.parameters.viscosity_table != nullptr,
            name_of(s.fluid.law.model) + " viscosity", "viscosity that depends on shear");
  parts.add(p.kernel.parameters.smagorinsky > 0.0,
            p.kernel.eddies == EddyModel::Wale ? "WALE turbulence" : "Smagorinsky turbulence",
            "turbulence model");
}

void add_solid_parts(const Scene& s, const Plan& p, Parts& parts) {
  const bool imb = p.scheme == SolidScheme::ImmersedMovingBoundary;
  parts.add(
      p.kernel.solid_term != SolidTerm::None || !imb,
      imb ? "covered cells " + name_of(p.kernel.solid_term) + weight_text(p.kernel) + ", loads"
          : name_of(p.scheme) + ", loads",
      "solids");
  const auto moving = std::ranges::count_if(
      s.obstacles, [](const ObstacleScene& o) { return o.motion.has_value(); });
  parts.add(!s.obstacles.empty(),
            fmt::format("{} obstacles at rest{}",
                        static_cast<std::ptrdiff_t>(s.obstacles.size()) - moving,
                        moving > 0 ? fmt::format(", {} that move", moving) : ""),
            "obstacles");
  parts.add(s.coupling.has_value(), "solid program");
  parts.add(s.box.dimension == 3, "three dimensions", "3D");
  parts.add(p.kernel.precision == Precision::Single, "single precision");
  if (!s.coupling) return;
  parts.add(s.coupling->inner_inertia, "inertia of the fluid inside");
  parts.add(s.coupling->buoyancy != protocol::Buoyancy::None,
            std::string("buoyancy ") + buoyancy_text(s.coupling->buoyancy), "buoyancy");
  parts.add(s.coupling->lubrication_range > 0.0, "lubrication");
}

/// The bodies of a scene as far as it says where they are.
std::vector<Body> known_bodies(const Scene& s, const Plan& p) {
  if (!s.coupling) return {};
  std::vector<Body> bodies = obstacle_bodies(s, p);
  for (const Vec3& x : s.particles->start)
    bodies.push_back({static_cast<std::int64_t>(bodies.size() + 1), p.units.to_lattice_position(x),
                      0.5 * s.particles->diameter.hi / p.units.dx});
  return bodies;
}

}  // namespace

std::string describe_cost(const Scene& s, const Plan& p) {
  Parts parts(name_of(p.kernel.lattice) + ", collision " + name_of(p.kernel.collision));
  add_fluid_parts(s, p, parts);
  add_solid_parts(s, p, parts);
  Fluid fluid = make_fluid(s, p);
  const double step = measure_step(fluid, known_bodies(s, p));
  double bytes = 0.0;
  for (const auto& [part, size] : fluid.bytes()) bytes += size;
  const double cells = static_cast<double>(p.domain.nx) * p.domain.ny * p.domain.nz;
  const double total = step * static_cast<double>(p.intervals) * p.fluid_steps;
  return fmt::format(
      "on           {}\noff          {}\n"
      "cost         {:.3g} MB; {:.3g} s of fluid at the {:.3g} million updates/s just measured, "
      "one "
      "thread{}\n",
      parts.on(), parts.off(), bytes * 1e-6, total, cells / step * 1e-6,
      s.coupling ? "; the solid's time comes on top" : "");
}

namespace {

/// Where a flow that was to be held has not been found.
std::string say_missed_flow(const Summary& s) {
  constexpr double close = 0.05;
  const auto flow = s.parameters.find("flow"), wanted = s.parameters.find("wanted_flow");
  if (flow == s.parameters.end() ||
      std::abs(flow->second - wanted->second) <= close * std::abs(wanted->second))
    return "";
  return fmt::format(
      "\nhint         the flow at the end is {:.3g} m³/s, wanted is {:.3g}: flow.csv shows whether "
      "it "
      "is still on its way (run.end_time) or something blocks it",
      flow->second, wanted->second);
}

/// Of a run's time, beyond which the exchange waits for a busy machine and says nothing of the
/// work.
constexpr double kBusyExchange = 1.0 / 3.0;

/// What to do about the time that the fluid waits for the solid. In turns one side computes while
/// the other waits, so that both at once take the time of the longer one.
std::string hint_of_waiting(const Summary& s) {
  if (!s.time_share.contains("waiting") || s.wall_seconds < 1.0) return "";
  const double waits = s.time_share.at("waiting");
  if (s.time_share.contains("exchange") && s.time_share.at("exchange") > kBusyExchange) return "";
  if (waits < 0.1)
    return fmt::format(
        "\nhint         the solid keeps the fluid waiting {:.0f} % of its time only: more cores "
        "go to the fluid (--threads)",
        100.0 * waits);
  if (waits <= 0.2) return "";
  std::string hint = fmt::format(
      "\nhint         the fluid waits {:.0f} % of its time for the solid: --solid-ranks",
      100.0 * waits);
  if (!s.overlapped)
    hint += fmt::format(
        ", or coupling.schedule = \"overlapped\", which would save up to {:.0f} % where each "
        "program has its own cores; loads are then one interval old",
        100.0 * std::min(waits, 1.0 - waits));
  return hint;
}

}  // namespace

std::string describe(const Summary& s) {
  std::string solid = s.solid ? describe(*s.solid) : std::string();
  if (!solid.empty()) solid = "solid        " + solid + "\n";
  std::string out = fmt::format(
      "ending       {}\n"
      "made         {} steps of {} cells, {:.6g} s, in {:.3g} s: {:.1f} million updates/s\n"
      "largest      Ma = u/c_s {:.3g}, u/C {:.3g}; mass drift {:.2g}\n"
      "{}time         ",
      s.ending, s.steps, s.cells, s.physical_seconds, s.wall_seconds, s.mlups, s.ma_max, s.ma_paper,
      s.mass_drift, solid);
  for (const auto& [part, share] : s.time_share)
    out += fmt::format("{} {:.0f} %  ", part, 100.0 * share);
  return out + say_missed_flow(s) + hint_of_waiting(s);
}

}  // namespace lbm
