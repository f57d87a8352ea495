// SPDX-License-Identifier: MIT
#include "protocol/wire/agreement.h"

#include <algorithm>
#include <cmath>

#include "protocol/wire/text.h"

namespace protocol {
namespace {

// Lengths and times come through a script's decimal text: equal up to a few round-off units of it.
constexpr double kTolerance = 1e-9;

bool equal(double a, double b, double scale) {
  return std::abs(a - b) <= kTolerance * scale;
}

const char* text(Buoyancy b) {
  switch (b) {
    case Buoyancy::ByFluid:
      return "added by the fluid";
    case Buoyancy::BySolid:
      return "added by the solid";
    case Buoyancy::None:
      return "not modelled";
  }
  return "unknown";
}

const char* text(Schedule s) {
  return s == Schedule::Serial ? "serial" : s == Schedule::Overlapped ? "overlapped" : "unknown";
}

class Comparison {
 public:
  Comparison(const Hello& fluid, const Hello& solid) : f_(fluid), s_(solid) {}

  std::vector<std::string> all() {
    roles();
    geometry();
    forces();
    time();
    particles();
    return std::move(found_);
  }

 private:
  template <class... Args>
  void add(Pattern<sizeof...(Args)> pattern, const Args&... args) {
    found_.push_back(format(pattern, args...));
  }

  void roles() {
    if (f_.role != Role::Fluid || s_.role != Role::Solid)
      add("roles: '{}' and '{}' are not one fluid and one solid program", f_.program, s_.program);
    if (f_.units != s_.units) add("units: fluid {}, solid {}", f_.units, s_.units);
    if (f_.schedule != s_.schedule)
      add("coupling schedule: fluid {}, solid {}", text(f_.schedule), text(s_.schedule));
    if ((f_.features & ~s_.features & kCheckpoints) != 0)
      add("checkpoints: the fluid's scene wants them (run.checkpoint_every), '{}' cannot write any",
          s_.program);
    if ((f_.features & ~s_.features & ~kCheckpoints) != 0)
      add("protocol features: fluid 0x{:x}, solid 0x{:x}", f_.features, s_.features);
  }

  void geometry() {
    if (f_.dimension != s_.dimension)
      add("dimension: fluid {}, solid {}", f_.dimension, s_.dimension);
    const char* axis[] = {"x", "y", "z"};
    for (unsigned k = 0; k < f_.dimension; ++k) {
      const double length = f_.box_hi[k] - f_.box_lo[k];
      if (!equal(f_.box_lo[k], s_.box_lo[k], length) || !equal(f_.box_hi[k], s_.box_hi[k], length))
        add("box {}: fluid {:.9g} … {:.9g} m, solid {:.9g} … {:.9g} m", axis[k], f_.box_lo[k],
            f_.box_hi[k], s_.box_lo[k], s_.box_hi[k]);
      if (f_.periodic[k] != s_.periodic[k])
        add("boundary {}: fluid {}, solid {}", axis[k],
            f_.periodic[k] ? "periodic" : "not periodic",
            s_.periodic[k] ? "periodic" : "not periodic");
    }
    if (f_.dimension == 2 && !equal(f_.depth, s_.depth, f_.depth))
      add("depth: fluid {:.9g} m, solid {:.9g} m (the solid's box in z spans the depth)", f_.depth,
          s_.depth);
  }

  void forces() {
    const double g = std::max(1e-300, std::hypot(f_.gravity[0], f_.gravity[1], f_.gravity[2]));
    for (int k = 0; k < 3; ++k)
      if (!equal(f_.gravity[k], s_.gravity[k], g)) {
        add("gravity: fluid ({:.9g}, {:.9g}, {:.9g}) m/s², solid ({:.9g}, {:.9g}, {:.9g}) m/s²",
            f_.gravity[0], f_.gravity[1], f_.gravity[2], s_.gravity[0], s_.gravity[1],
            s_.gravity[2]);
        break;
      }
    if (f_.buoyancy != s_.buoyancy)
      add("buoyancy: fluid says '{}', solid says '{}'", text(f_.buoyancy), text(s_.buoyancy));
  }

  void time() {
    const double fluid = f_.step * f_.fluid_steps, solid = s_.step * s_.solid_steps;
    if (f_.solid_steps != s_.solid_steps)
      add("substeps: fluid's scene says {} solid steps an interval, solid makes {}", f_.solid_steps,
          s_.solid_steps);
    if (!equal(fluid, solid, fluid))
      add("coupling interval: fluid {:.9g} s ({} × {:.9g} s), solid {:.9g} s ({} × {:.9g} s)",
          fluid, f_.fluid_steps, f_.step, solid, s_.solid_steps, s_.step);
    if (f_.first_interval != s_.first_interval)
      add("first coupling interval: fluid {}, solid {}", f_.first_interval, s_.first_interval);
  }

  void particles() {
    if (f_.particles && s_.particles && *f_.particles != *s_.particles)
      add("particles: fluid's scene expects {}, solid has {}", *f_.particles, *s_.particles);
    if (s_.particles && *s_.particles == 0) return;
    compare("radius", "m", f_.radius, s_.radius, "");
    compare("density", "kg/m³", f_.density, s_.density,
            f_.dimension == 3          ? ""
            : s_.program == "liggghts" ? "; LIGGGHTS discs have unit depth: set density times depth"
                                       : "; the mass of a disc is π r² × density × depth");
  }

  /// The solid's range must lie inside the one the fluid's scene states.
  void compare(const char* what, const char* unit, const std::optional<Range>& fluid,
               const std::optional<Range>& solid, const char* hint) {
    if (!fluid || !solid) return;
    const double slack = 1e-6 * fluid->hi;
    if (solid->lo < fluid->lo - slack || solid->hi > fluid->hi + slack)
      add("particle {}: fluid's scene says {:.9g} … {:.9g} {}, solid has {:.9g} … {:.9g} {}{}",
          what, fluid->lo, fluid->hi, unit, solid->lo, solid->hi, unit, hint);
  }

  const Hello &f_, &s_;
  std::vector<std::string> found_;
};

}  // namespace

std::vector<std::string> disagreements(const Hello& fluid, const Hello& solid) {
  return Comparison(fluid, solid).all();
}

}  // namespace protocol
