// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/scene_keys.h"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/io/table_reader.h"

namespace lbm {
namespace {

/// Scenes that together make the reader ask for every key that it knows. A key that only one branch
/// of the reader asks for needs a scene that takes this branch.
constexpr std::string_view kScenes[] = {
    R"(
box.size = [1, 1]
fluid = {density = 1, kinematic_viscosity = 1, velocity_scale = 1}
numerics.cell = 0.1
particles = {diameter = 0.1, density = 1}
run.end_time = 1
coupling.buoyancy = "fluid"
boundary = [{side = "left", kind = "velocity", velocity = [0, 0]}, {side = "right", kind = "pressure"}]
obstacle = [{centre = [0, 0], diameter = 1}, {from = [0, 0], to = [1, 1]}]
sensor = [{name = "a", kind = "plane", axis = "x", at = 0, from = [0, 0], to = [1, 1]},
          {name = "b", kind = "line", from = [0, 0], to = [1, 1]}, {name = "c", kind = "side", side = "left"}]
average.from = 0
)",
    R"(
box.size = [1, 1, 1]
fluid = {density = 1, kinematic_viscosity = 1, velocity_scale = 1}
numerics.cell = 0.1
run.end_time = 1
boundary = [{side = "front", kind = "outflow", from = [0, 0], to = [1, 1]}]
obstacle = [{centre = [0, 0, 0], diameter = 1}]
sensor = [{name = "a", kind = "plane", axis = "z", at = 0}, {name = "b", kind = "side", side = "front"}]
)",
    R"(
box.size = [1, 1]
fluid = {density = 1, velocity_scale = 1, viscosity = {model = "herschel_bulkley", consistency = 1, index = 1, yield_stress = 1}}
numerics.cell = 0.1
run.end_time = 1
)",
    R"(
box.size = [1, 1]
fluid = {density = 1, velocity_scale = 1, viscosity = {model = "carreau", index = 0.5, time_constant = 1, nu_min = 1, nu_max = 2}}
numerics.cell = 0.1
run.end_time = 1
)",
    R"(
box.size = [1, 1, 1]
fluid = {density = 1, kinematic_viscosity = 1, velocity_scale = 1}
numerics.cell = 0.1
run.end_time = 1
obstacle = [{mesh = "none.stl"}]
)",
    R"(
box.size = [1, 1, 1]
fluid = {density = 1, kinematic_viscosity = 1, velocity_scale = 1}
numerics.cell = 0.1
run.end_time = 1
obstacle = [{centre = [0, 0, 0], diameter = 1, motion = "rotation", angular_velocity = 1, axis = [0, 0, 1]},
            {centre = [0, 0, 0], diameter = 1, motion = "table", motion_table = "none.csv"}]
)",
    R"(
box.size = [1, 1]
fluid = {density = 1, kinematic_viscosity = 1, velocity_scale = 1}
numerics.cell = 0.1
run.end_time = 1
obstacle = [{centre = [0, 0], diameter = 1, motion = "linear", velocity = [1, 0]},
            {centre = [0, 0], diameter = 1, motion = "rotation", angular_velocity = 1, about = [0, 0]},
            {centre = [0, 0], diameter = 1, motion = "oscillation", amplitude = [1, 0], angular_amplitude = 1, frequency = 1},
            {image = "none.raw", voxel = 1, threshold = 1, at = [0, 0], cut_from = [0, 0], cut_to = [1, 1], raw_size = [1, 1]}]
)"};

/// What the reader does not know of a key.
struct Meaning {
  std::string_view key, sentence;
  std::string_view fallback = {};  ///< in words, where it is no fixed value
  std::string_view range = {};     ///< in words
};

constexpr Meaning kMeanings[] = {
    {"title", "Name of the scene in logs and pictures.", "file name"},
    {"box.size",
     "Lengths [x, y] of the box, or [x, y, z] for a scene in three dimensions, where every vector "
     "below has three components.",
     {},
     "> 0"},
    {"box.origin", "Lower corner of the box."},
    {"box.depth", "Thickness of the layer that forces and masses of two dimensions belong to."},
    {"box.sides_x", "Walls (no-slip) or periodic sides left and right."},
    {"box.sides_y", "The same of bottom and top."},
    {"box.sides_z", "The same of back and front, in three dimensions."},
    {"box.pressure_jump", "Pressure of the low side minus that of the high side, if periodic."},
    {"fluid.density", "Density of the fluid."},
    {"fluid.kinematic_viscosity", "Kinematic viscosity of the fluid.",
     "required without fluid.viscosity"},
    {"fluid.viscosity.model", "Law of a viscosity that depends on the shear rate (viscosity.md)."},
    {"fluid.viscosity.consistency", "K; of a Bingham fluid the plastic viscosity, in Pa s.",
     "required"},
    {"fluid.viscosity.index", "Index n of the law.", "required"},
    {"fluid.viscosity.yield_stress", "Stress below which the fluid hardly moves.", "required"},
    {"fluid.viscosity.regularisation", "What replaces the law below the yield stress."},
    {"fluid.viscosity.time_constant", "λ of Carreau's law.", "required"},
    {"fluid.viscosity.nu_min", "Lower bound of the kinematic viscosity.",
     "typical viscosity / 100, of a bingham fluid at most K/ρ"},
    {"fluid.viscosity.nu_max", "Upper bound of the kinematic viscosity.",
     "typical viscosity × 100"},
    {"fluid.viscosity.shear_rate",
     "A typical shear rate, at which the viscosity counts as the viscosity.",
     "velocity_scale / length"},
    {"fluid.viscosity.smagorinsky", "As numerics.smagorinsky, on top of any law."},
    {"fluid.gravity", "Gravity, which acts on the particles; the fluid gives them buoyancy."},
    {"fluid.body_force", "Acceleration that drives the fluid."},
    {"fluid.body_force_ramp", "Time in which the body force comes up as ½(1 - cos)."},
    {"fluid.body_force_frequency", "The body force is multiplied by cos(2πft)."},
    {"fluid.body_force_table",
     "The body force is multiplied by a factor over time, from a file as boundary.table."},
    {"fluid.body_force_repeat", "periodic: the table begins anew after its last line."},
    {"fluid.flow_rate",
     "Flow through a periodic box, of fluid and solids, for which a body force is found; flow.csv "
     "has "
     "both (boundaries.md)."},
    {"fluid.flow_axis", "Axis along which it flows."},
    {"fluid.flow_ramp", "Time in which the flow comes up as ½(1 - cos)."},
    {"fluid.velocity_scale",
     "Characteristic velocity: the largest speed to expect of fluid or particle."},
    {"numerics.cell", "Size of a cell; give it or cells_per_diameter.", "from cells_per_diameter"},
    {"numerics.cells_per_diameter", "Cells across the smallest particle; give it or cell.",
     "from cell"},
    {"numerics.time_step", "Time step of the fluid.", "by rule (collision.md)"},
    {"numerics.lattice", "Velocity set; auto takes D2Q9, in three dimensions D3Q19."},
    {"numerics.precision",
     "Of the populations; single halves the memory (not with recursive_regularised)."},
    {"numerics.collision", "Collision operator of the fluid (collision.md)."},
    {"numerics.solid_term", "Solid collision operator of covered cells (solids.md)."},
    {"numerics.scheme", "How solids act on the fluid (solids.md)."},
    {"numerics.spring_stiffness",
     "Of spring_immersed_boundary, in lattice units; unstable above about 0.01."},
    {"numerics.weight",
     "Weight B of operators that have one; auto takes viscous, in three dimensions balanced "
     "(solids.md)."},
    {"numerics.blocks",
     "Blocks of the ranks: of equal size or of equal work, as it is known at the start and as the "
     "solids move (parallel.md)."},
    {"numerics.waiting_bound",
     "Share of their time that ranks may wait for the busiest one before blocks of equal work are "
     "cut anew; 0: whenever the covered cells give other cuts, 1: never (parallel.md)."},
    {"numerics.smagorinsky", "Constant S_c of the turbulence model; 0 leaves it out."},
    {"numerics.eddy_viscosity",
     "wale: it vanishes at walls and solids as it should (viscosity.md); S_c stays its strength."},
    {"numerics.magic", "Λ of TRT.", "3/16; 1/10 beside cells by resistance"},
    {"particles.diameter", "Diameter of the particles."},
    {"particles.density", "Density of the particles."},
    {"particles.hydraulic_ratio",
     "Radius that the flow sees over the particle's, one number or one a type; buoyancy is that "
     "of the whole particle."},
    {"particles.start", "Centres of particles, offered to the script as particle1_x and so on."},
    {"particles.contact_stiffness", "Stiffness of contacts; it bounds the solid's time step.",
     "none"},
    {"particles.variables.NAME", "Any further number or text for the script."},
    {"coupling.fluid_steps",
     "Fluid steps a coupling interval, whose loads are averaged; tested up to 10.", "1"},
    {"coupling.substeps", "Solid steps a coupling interval.", "by rule (collision.md)"},
    {"coupling.inner_inertia", "Corrects loads for the inertia of the fluid inside a particle."},
    {"coupling.buoyancy", "Which program adds the buoyancy."},
    {"coupling.carry_weight",
     "In a box that is periodic along gravity a body force on the fluid carries the weight of all "
     "particles, so that the mixture as a whole does not fall."},
    {"coupling.virtual_mass",
     "Virtual mass of a particle over the mass of the fluid that it covers (loads.md).",
     "1 for light particles (loads.md), else 0"},
    {"coupling.lubrication_range", "Gap below which lubrication acts; 0 leaves it out."},
    {"coupling.schedule",
     "serial-explicit, or parallel-explicit: both programs at once, loads one interval old."},
    {"coupling.timeout",
     "Longest wait of either program for the other, and of a rank for another of its program."},
    {"coupling.connect_timeout",
     "How long the solid's program may take to start, e.g. to import what it needs."},
    {"run.end_time", "Time at which the run ends."},
    {"run.steady_below",
     "A fluid alone ends where its velocity changes by less than this a turnover; 0: never."},
    {"run.checkpoint_every", "Both programs write a checkpoint this often; 0: never."},
    {"boundary.side", "Side of the box; back and front in three dimensions."},
    {"boundary.kind", "What holds there in place of a wall at rest (boundaries.md)."},
    {"boundary.from",
     "Where it begins along the side, on cell borders; in three dimensions a pair, along the "
     "side's two axes.",
     "whole side", "the side"},
    {"boundary.to", "Where it ends, as from.", "whole side", "the side"},
    {"boundary.velocity",
     "Velocity of a velocity or moving_wall; at the middle of a parabolic profile.",
     "required there"},
    {"boundary.profile", "Profile of the velocity along the opening."},
    {"boundary.profile_table",
     "The velocity is multiplied by a factor along the side: a file beside the scene that begins "
     "with "
     "its axes and factor, as y,factor [m, 1] (boundaries.md)."},
    {"boundary.frequency",
     "The velocity or pressure is multiplied by cos(2πft); not of an outflow."},
    {"boundary.table",
     "The velocity or pressure is multiplied by a factor over time: a file beside the scene that "
     "begins with the line time,factor [s, 1], straight between its lines."},
    {"boundary.repeat", "periodic: the table begins anew after its last line."},
    {"boundary.pressure", "Pressure of a pressure or outflow, against the reference."},
    {"boundary.flow_rate",
     "Flow into the box through a pressure boundary, for which its pressure is found from "
     "`pressure` "
     "on; flow.csv has both (boundaries.md)."},
    {"boundary.ramp", "Time in which the value comes up as ½(1 - cos)."},
    {"obstacle.centre", "Centre of a disc or sphere.", "required without from, mesh and image"},
    {"obstacle.diameter", "Its diameter, or that of a cylinder.", "required with centre"},
    {"obstacle.hollow",
     "Whether the solid is everything outside of the circle, sphere, cylinder or mesh."},
    {"obstacle.spin", "Angular velocity of a disc (a number) or sphere (a vector)."},
    {"obstacle.from",
     "Lower corner of a block, of whole cells where it is at rest; with a diameter the centre of a "
     "cylinder's end (3D).",
     "required without centre, mesh and image"},
    {"obstacle.to", "Upper corner of the block, or the centre of the cylinder's other end.",
     "required with from"},
    {"obstacle.mesh", "Triangle mesh, an .stl file beside the scene (shapes.md).",
     "required without centre, from and image"},
    {"obstacle.scale", "Metres per unit of the mesh's file.", "1"},
    {"obstacle.rotate", "Axis x, y, z through the file's origin, and degrees.", "none"},
    {"obstacle.move", "Where the mesh goes after that."},
    {"obstacle.thickness", "Makes a layer of the mesh's surface, which may then be open.", "none"},
    {"obstacle.motion", "How a disc, sphere, block or mesh moves (shapes.md).", "at rest"},
    {"obstacle.velocity", "Of a linear motion.", "required with motion = \"linear\""},
    {"obstacle.angular_velocity", "Of a rotation.", "required with motion = \"rotation\""},
    {"obstacle.axis", "Direction of the axis of a rotation, in three dimensions.",
     "required where it turns"},
    {"obstacle.about", "Place through which the axis goes, and about which the torque is.",
     "middle of the obstacle"},
    {"obstacle.amplitude", "Of an oscillation: amplitude × sin(2π frequency t)."},
    {"obstacle.angular_amplitude", "Of an oscillation about the axis."},
    {"obstacle.frequency", "Of an oscillation.", "required with motion = \"oscillation\""},
    {"obstacle.motion_table",
     "Table `time,x,y[,z][,angle]` of a motion against the obstacle's place, beside the scene.",
     "required with motion = \"table\""},
    {"obstacle.surface_only",
     "Whether the obstacle stays in its cells and its surface has the velocity, as that of a "
     "drum."},
    {"obstacle.image", "Image beside the scene: .raw, .npy, .h5, .png or .tif (shapes.md).",
     "required without centre, from and mesh"},
    {"obstacle.voxel", "Size of a voxel.", "required with image"},
    {"obstacle.at", "Lower corner of the image.", "box.origin"},
    {"obstacle.threshold", "Level from which on the image is solid.",
     "required without grey_levels"},
    {"obstacle.solid", "Whether levels above or below the threshold are solid."},
    {"obstacle.grey_levels",
     "Levels of fluid and of solid, the higher first where solid is dark; between them are solid "
     "fractions.",
     "none"},
    {"obstacle.cut_from", "Lower corner of the part of the image that counts.", "all"},
    {"obstacle.cut_to", "Upper corner of that part.", "all"},
    {"obstacle.raw_size", "Voxels along x, y, z of a .raw file.", "required with .raw"},
    {"obstacle.raw_type", "Type of its numbers.", "required with .raw"},
    {"obstacle.dataset", "Data set of a .h5 file.", "required with .h5"},
    {"grains.file",
     "Table x,y,diameter (x,y,z,diameter) in m of discs (spheres) at rest, beside the scene; at "
     "most 256 MB.",
     "none"},
    {"initial.kind", "Flow at the beginning; channel is a parabola across y."},
    {"initial.velocity", "Velocity of a uniform flow; its x component is the amplitude of others."},
    {"initial.sharpness", "Steepness of the shear layers."},
    {"initial.perturbation", "Disturbance of the shear layers over the velocity."},
    {"output.fields_every", "How often fields are written; 0: never."},
    {"output.viscosity", "Whether the fields have the viscosity of each cell (viscosity.md)."},
    {"output.probe_every",
     "How often probes, points and loads of obstacles are written; 0: every interval."},
    {"output.points", "Places whose pressure and velocity are written."},
    {"output.probe_particles", "Ids of the particles that have rows in probes.csv.", "all"},
    {"average.from",
     "Means and root mean squares over time of velocity and pressure are taken from then on."},
    {"average.every", "Time from one sample to the next; 0: every coupling interval."},
    {"sensor.name", "Name of the sensor; its table is sensor-NAME.csv.", "required"},
    {"sensor.kind", "What it looks at (scene.md, Sensors).", "required"},
    {"sensor.every", "Time from one row to the next; 0: every coupling interval."},
    {"sensor.axis", "Axis across a plane.", "required of a plane"},
    {"sensor.at", "Place of a plane on its axis; the nearest between two layers of cells is taken.",
     "required of a plane", "the box"},
    {"sensor.from", "Corner of the part of a plane that counts, or one end of a line.",
     "whole plane"},
    {"sensor.to", "The opposite corner, or the other end.", "whole plane"},
    {"sensor.count", "Places along a line.", "20"},
    {"sensor.side", "Side of the box.", "required of a side"},
};

const KeyNote* note_of(const KeyNotes& keys, std::string_view key) {
  const auto found = std::find_if(keys.all().begin(), keys.all().end(),
                                  [&](const KeyNote& n) { return n.key == key; });
  return found == keys.all().end() ? nullptr : &*found;
}

bool has_meaning(const KeyNote& note) {
  return std::any_of(std::begin(kMeanings), std::end(kMeanings),
                     [&](const Meaning& m) { return m.key == note.key; });
}

KeyNotes all_keys() {
  KeyNotes keys;
  for (const std::string_view scene : kScenes) try {
      note_keys(std::string(scene), keys);
    } catch (const InputError&) {
      // The file of a mesh or image is looked for after all keys of its table.
    }
  return keys;
}

/// Alternatives with a separator of words; "|" would end a cell of the table.
std::string alternatives(const std::string& list, const char* separator) {
  std::string out;
  for (const char c : list)
    if (c == '|')
      out += separator;
    else
      out += c;
  return out;
}

std::string row(const KeyNote& note, const Meaning& meaning) {
  const std::string range =
      meaning.range.empty() ? alternatives(note.range, ", ") : std::string(meaning.range);
  return fmt::format(
      "| `{}` | {} | {} | {} | {} | {} |\n", note.key, alternatives(note.type, " or "), note.unit,
      meaning.fallback.empty() ? note.fallback : meaning.fallback, range, meaning.sentence);
}

}  // namespace

std::string describe_keys() {
  const KeyNotes keys = all_keys();
  std::string out =
      "| key | type | unit | default | range | meaning |\n|---|---|---|---|---|---|\n";
  for (const Meaning& m : kMeanings)
    if (const KeyNote* note = note_of(keys, m.key)) out += row(*note, m);
  for (const KeyNote& note : keys.all())
    if (!has_meaning(note)) out += row(note, {});
  return out;
}

std::vector<std::string> complaints_about_keys() {
  const KeyNotes keys = all_keys();
  std::vector<std::string> complaints;
  for (const KeyNote& note : keys.all())
    if (!has_meaning(note))
      complaints.push_back(note.key +
                           " has no sentence: add one to kMeanings in io/scene_keys.cpp");
  for (const Meaning& m : kMeanings)
    if (!note_of(keys, m.key))
      complaints.push_back(
          fmt::format("{} has a sentence, but no scene of kScenes in io/scene_keys.cpp makes the "
                      "reader ask for "
                      "it: add one, or take the sentence out",
                      m.key));
  return complaints;
}

}  // namespace lbm
