// SPDX-License-Identifier: MIT
/// A small solid program in C++, to copy: its conversation with the fluid. It has no input file:
/// everything that it needs comes as variables of the fluid's scene. Its particles are in discs.h,
/// what it knows of the library is in solid.h.
///
/// The variable `clump`, "x,y,z,r:x,y,z,r…" in metres about any point, makes one of each particle.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <numbers>
#include <sstream>
#include <string>

#include "discs.h"
#include "solid.h"

namespace {

const std::string kAxes[] = {"x", "y"};

// ---- what the scene says ------------------------------------------------------------------------

Box read_box(const Solid& solid) {
  Box box;
  for (int k = 0; k < 2; ++k) {
    box.low[k] = solid.number(kAxes[k] + "_lo");
    box.high[k] = solid.number(kAxes[k] + "_hi");
    box.periodic[k] = solid.text("boundary_" + kAxes[k]) == "p";
    box.walls[k] = solid.number("walls_" + kAxes[k]) != 0.0;
  }
  return box;
}

bplbm_shape disc(double radius, double mass) {
  return {.id = 0,
          .radius = radius,
          .mass = mass,
          .inertia = 0.5 * mass * radius * radius,
          .type = 1,
          .epoch = 0,
          .carrier = BPLBM_ITSELF,
          .volume = 0.0};
}

struct Parts {
  std::vector<double> places, radii;  ///< [n][3], [n]
};

Parts read_clump(const Solid& solid, const Box& box) {
  std::string text = solid.text("clump");
  const auto commas = std::ranges::count(text, ','), colons = std::ranges::count(text, ':');
  for (char& c : text)
    if (c == ',' || c == ':') c = ' ';
  std::istringstream numbers(text);
  const double most = std::max(box.high[0] - box.low[0], box.high[1] - box.low[1]);
  Parts parts;
  bool fit = true;
  for (double x, y, z, r; numbers >> x >> y >> z >> r;) {
    parts.places.insert(parts.places.end(), {x, y, z});
    parts.radii.push_back(r);
    fit = fit && r > 0.0 && std::max({r, std::abs(x), std::abs(y)}) <= most;
  }
  const auto n = std::ssize(parts.radii);
  if (n == 0 || !numbers.eof() || commas != 3 * n || colons != n - 1 || !fit)
    solid.fail(BPLBM_BAD_INPUT, "the variable 'clump' = '" + solid.text("clump") +
                                    "' is no list of x,y,z,r:x,y,z,r… with radii above 0, in a "
                                    "clump no larger than the box; correct [particles.variables]");
  return parts;
}

/// Discs in the frame of their clump, whose centre is that of their union.
void make_clump(const Solid& solid, const Box& box, double density, Kind& kind) {
  const auto [places, radii] = read_clump(solid, box);
  double centre[3]{};
  kind.shapes[0] = solid.clump(places, radii, density, centre);
  for (std::size_t j = 0; j < radii.size(); ++j) {
    kind.arms.push_back({places[3 * j] - centre[0], places[3 * j + 1] - centre[1]});
    kind.shapes.push_back(disc(radii[j], 0.0));
  }
}

Kind read_kind(const Solid& solid, const Box& box) {
  const double radius = 0.5 * solid.number("diameter_max"), density = solid.number("density_max");
  const double mass = density * std::numbers::pi * radius * radius * solid.number("depth");
  Kind kind{.shapes = {disc(radius, mass)}, .arms = {Vec2{}}};
  if (solid.has("clump")) make_clump(solid, box, density, kind);
  kind.stiffness = solid.number_or("contact_stiffness", 1e5);
  kind.damping = 2.0 * solid.number_or("damping_ratio", 0.5) * std::sqrt(mass * kind.stiffness);
  const double g = solid.number("gravity");
  kind.gravity = {g * solid.number("gravity_x"), g * solid.number("gravity_y")};
  return kind;
}

/// What both sides compare: what this program computes with, not what the fluid said.
bplbm_setup setup_of(const Solid& solid, const Box& box, const Kind& kind) {
  bplbm_setup setup = solid.scene();
  setup.dimension = 2;
  setup.periodic[2] = 1;
  for (int k = 0; k < 2; ++k) {
    setup.periodic[k] = box.periodic[k];
    setup.box_low[k] = box.low[k];
    setup.box_high[k] = box.high[k];
    setup.gravity[k] = kind.gravity[k];
  }
  setup.box_low[2] = solid.number("z_lo");
  setup.box_high[2] = solid.number("z_hi");
  setup.gravity[2] = 0.0;
  setup.depth = solid.number("depth");
  if (setup.buoyancy != BPLBM_BUOYANCY_NONE) setup.buoyancy = BPLBM_BUOYANCY_BY_FLUID;
  setup.schedule = BPLBM_SERIAL;
  setup.step = solid.number("solid_step");
  setup.steps = static_cast<std::int32_t>(solid.number("substeps"));
  setup.checkpoints = 1;
  for (int side = 0; side < 6; ++side) setup.sides[side] = side < 4 && box.walls[side / 2];
  std::fill_n(setup.radius, 2, 0.0);  // not said: the fluid looks at each particle
  std::fill_n(setup.density, 2, 0.0);
  return setup;
}

// ---- what comes and goes ------------------------------------------------------------------------

/// Takes particles out of the box and puts others into it, as the scene says for an interval.
void change(Discs& discs, const Solid& solid, std::int64_t interval) {
  const auto when = static_cast<double>(interval);
  for (int i = 1; solid.has("particle" + std::to_string(i) + "_x"); ++i) {
    const std::string p = "particle" + std::to_string(i) + "_";
    bplbm_state s{};
    s.id = static_cast<std::int64_t>(solid.number_or(p + "id", i));
    if (solid.number_or(p + "until", -1.0) == when) discs.remove(s.id);
    if (solid.number_or(p + "interval", 0.0) != when) continue;
    for (int k = 0; k < 2; ++k) {
      s.x[k] = solid.number(p + kAxes[k]);
      s.v[k] = solid.number_or(p + "v" + kAxes[k], 0.0);
    }
    discs.add(s, interval);
  }
}

// ---- checkpoints: every path is decided by places and velocities --------------------------------

constexpr char kPart[8] = {'d', 'i', 's', 'c', 's', ' ', '1', '\n'};

template <class Record>
void append(std::string& part, const std::vector<Record>& records) {
  part.append(reinterpret_cast<const char*>(records.data()), records.size() * sizeof(Record));
}

std::string part_of(const Discs& discs) {
  std::string part(kPart, sizeof kPart);
  append(part, discs.states);
  append(part, discs.shapes);
  return part;
}

void read_part(const Solid& solid, Discs& discs) {
  const std::string name = solid.text("restart_file");
  std::ifstream file(name, std::ios::binary);
  const std::string part{std::istreambuf_iterator<char>(file), {}};
  constexpr std::size_t each = sizeof(bplbm_state) + sizeof(bplbm_shape);
  if (!part.starts_with(std::string(kPart, sizeof kPart)) || (part.size() - sizeof kPart) % each)
    solid.fail(BPLBM_BAD_INPUT, name + " is no checkpoint of this engine");
  const std::size_t n = (part.size() - sizeof kPart) / each;
  discs.states.resize(n);
  discs.shapes.resize(n);
  const char* from = part.data() + sizeof kPart;
  std::memcpy(discs.states.data(), from, n * sizeof(bplbm_state));
  std::memcpy(discs.shapes.data(), from + n * sizeof(bplbm_state), n * sizeof(bplbm_shape));
}

// ---- the conversation ---------------------------------------------------------------------------

void run(const Solid& solid) {
  const Box box = read_box(solid);
  const Kind kind = read_kind(solid, box);
  bplbm_setup setup = setup_of(solid, box, kind);
  Discs discs(box, kind, setup.step);
  std::int64_t interval = setup.first_interval;
  if (interval > 0)
    read_part(solid, discs);
  else
    change(discs, solid, 0);
  setup.particles = discs.bodies();
  solid.agree(setup);
  std::vector<bplbm_load> loads;
  for (;;) {
    const std::uint32_t asked = solid.exchange(discs.states, discs.shapes, loads);
    if (asked & BPLBM_LAST) return;
    discs.advance(setup.steps, loads);
    change(discs, solid, ++interval);
    if (asked & BPLBM_CHECKPOINT) solid.keep(part_of(discs));
  }
}

}  // namespace

int main() {
  Solid solid("reference_engine", BPLBM_VERSION);
  try {
    run(solid);
  } catch (const std::exception& error) {
    solid.note(BPLBM_FAULT, error.what());
  }
  return solid.close();
}
