// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/obstacle_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "lbm_solver/io/image_file.h"
#include "lbm_solver/io/motion_reader.h"
#include "lbm_solver/io/stl_file.h"
#include "protocol/program/checksum.h"
#include "protocol/program/input_file.h"

namespace lbm {
namespace {

constexpr std::uintmax_t kLargestFile = 8'000'000'000;  // bytes
constexpr double kOtherUnit = 100.0;  // sizes of the box: a mesh that is larger is of another unit
constexpr double kSmall = 0.01;       // sizes of the box: one that a unit would make small does not
constexpr double kSide = 1e-6;        // of the box: a mesh that ends on its side

/// Units of length in which files come, in m.
struct FileUnit {
  double metres;
  const char* name;
};
constexpr FileUnit kUnits[] = {{1e-3, "mm"}, {1.0, "m"},   {0.0254, "inches"},
                               {1e-2, "cm"}, {1e-6, "µm"}, {0.3048, "feet"}};

/// The path of a file that a key names, and its checksum among the settings.
std::string file_of(TableReader& t, const std::string& key, const std::string& scene_file) {
  const std::string name = t.text_or(key, "");
  const auto path = std::filesystem::path(scene_file).parent_path() / name;
  if (const auto problem = protocol::why_unreadable(path, kLargestFile); !problem.empty())
    t.fail(key, "= \"" + name + "\": " + problem, "put the file beside the scene");
  t.note(key + "_content", fmt::format("checksum {:08x}", protocol::fingerprint(path).crc));
  return path;
}

/// Calls a reader of files; what it finds wrong is told with the key's place.
template <class Read>
auto read_file(TableReader& t, const std::string& key, const std::string& path, Read&& read) try {
  return read();
} catch (const std::invalid_argument& error) {
  const std::string text = error.what();
  const auto end = text.rfind("; ");
  t.fail(key,
         fmt::format("= \"{}\" {}", std::filesystem::path(path).filename().string(),
                     text.substr(0, end)),
         text.substr(end + 2));
}

std::string place_text(const Vec3& x) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g}) m", x.x(), x.y(), x.z());
}

/// Scales, turns about an axis through the file's origin, and moves.
void place(TriangleMesh& mesh, double scale, const std::vector<double>& turn, const Vec3& move) {
  Vec3 axis(turn[0], turn[1], turn[2]);
  axis.normalize();
  const double angle = turn[3] * std::numbers::pi / 180.0;
  const double cosine = std::cos(angle), sine = std::sin(angle);
  for (Vec3& v : mesh.vertices) {
    const Vec3 x = scale * v;
    const Vec3 across(axis.y() * x.z() - axis.z() * x.y(), axis.z() * x.x() - axis.x() * x.z(),
                      axis.x() * x.y() - axis.y() * x.x());
    v = cosine * x + sine * across + (1.0 - cosine) * axis.dot(x) * axis + move;
  }
}

/// Refuses a surface that is not closed or not turned one way.
void check_surface(const TableReader& t, const TriangleMesh& mesh, bool may_be_open) {
  const SurfaceDefects found = defects(mesh);
  const auto fail = [&](std::size_t count, const std::string& what, const Vec3& at,
                        const std::string& remedy) {
    t.fail("mesh", fmt::format("{} {}, the first at {}", count, what, place_text(at)), remedy);
  };
  if (found.crowded > 0)
    fail(found.crowded, "of its edges have more than two triangles", *found.at_crowded,
         "part the bodies that touch there, or join them into one surface");
  if (found.turned > 0)
    fail(found.turned, "of its edges lie between triangles that face opposite ways",
         *found.at_turned, "turn the flipped facets (a mesh tool calls it 'recalculate normals')");
  if (found.open > 0 && !may_be_open)
    fail(found.open, "of its edges are open: the surface has holes and encloses nothing",
         *found.at_open, "close them, or give the surface a thickness [m]");
}

/// Whether a surface has a part in the box, and whether all of it, as far as the boxes around show.
struct Reach {
  bool meets = true, within = true;

  Reach(const Vec3& low, const Vec3& high, const BoxScene& box) {
    for (int k = 0; k < 3; ++k) {
      const double from = box.origin[k], to = from + box.size[k], near = kSide * box.size[k];
      meets = meets && high[k] > from && low[k] < to;
      within = within && low[k] >= from - near && high[k] <= to + near;
    }
  }
};

std::string reach_text(const TriangleMesh& mesh) {
  const auto [low, high] = bounds(mesh);
  return fmt::format("reaches from {} to {}", place_text(low), place_text(high));
}

/// The largest scale by which a mesh would lie in the box and not be small in it, of the units that
/// files are in; as a message says it, and empty where there is none.
/// @param scale  that the mesh has
std::string scale_hint(const TriangleMesh& mesh, double scale, const Vec3& move,
                       const BoxScene& box) {
  const auto [low, high] = bounds(mesh);
  double largest = 0.0;
  std::string hint;
  for (const auto& [metres, unit] : kUnits) {
    const double times = metres / scale;
    const Vec3 from = times * (low - move) + move, to = times * (high - move) + move;
    if (metres == scale || metres <= largest || !Reach(from, to, box).within ||
        (to - from).maxCoeff() < kSmall * box.size.maxCoeff())
      continue;
    largest = metres;
    hint = fmt::format("is its file in {}? with scale = {:.6g} it would reach from {} to {}", unit,
                       metres, place_text(from), place_text(to));
  }
  return hint;
}

/// Refuses a mesh that has no part in the box, or is of another unit.
void check_size(const TableReader& t, const TriangleMesh& mesh, const std::string& hint,
                const BoxScene& box) {
  const auto [low, high] = bounds(mesh);
  const double size = (high - low).maxCoeff(), most = box.size.maxCoeff();
  if (size > kOtherUnit * most)
    t.fail("mesh", fmt::format("{}, {:.3g} times the box", reach_text(mesh), size / most),
           hint.empty() ? "are its lengths in mm? then give scale = 0.001" : hint);
  if (!Reach(low, high, box).meets)
    t.fail("mesh", reach_text(mesh) + ", outside of the box",
           "give move = [x, y, z] in m" + (hint.empty() ? "" : "; or " + hint));
}

MeshScene read_mesh(TableReader& t, const std::string& scene_file, const BoxScene& box) {
  MeshScene mesh;
  if (box.dimension == 2)
    t.fail("mesh", "is there in three dimensions only",
           "draw its section as an image, or take discs and blocks");
  const double scale = t.number_or("scale", 1.0, Bounds::positive(), "m per unit of the file");
  const std::vector<double> turn = t.numbers_or("rotate", {0.0, 0.0, 1.0, 0.0}, {}, "");
  if (turn.size() != 4 || turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2] == 0.0)
    t.fail("rotate", "is no axis and angle", "give [x, y, z of the axis, degrees]");
  const Vec3 move = t.vector_or_zero("move", 3, "[m]");
  mesh.hollow = t.flag_or("hollow", false);
  mesh.thickness = t.optional_number("thickness", Bounds::positive(), "m").value_or(0.0);
  mesh.file = file_of(t, "mesh", scene_file);
  TriangleMesh surface = read_file(t, "mesh", mesh.file, [&] { return read_stl(mesh.file); });
  place(surface, scale, turn, move);
  const std::string hint = scale_hint(surface, scale, move, box);
  check_size(t, surface, hint, box);
  mesh.other_scale = hint;
  check_surface(t, surface, mesh.thickness > 0.0);
  if (mesh.thickness > 0.0 && mesh.hollow)
    t.fail("hollow", "stands beside thickness", "give one of them");
  if (mesh.thickness > 0.0) surface = thickened(surface, mesh.thickness);
  mesh.volume = enclosed_volume(surface);
  if (!(mesh.volume > 0.0))
    t.fail("mesh", "has triangles that face inwards: it encloses less than nothing",
           "turn all of them; if the fluid is inside of the surface, give hollow = true as well");
  mesh.surface = std::make_shared<const TriangleMesh>(std::move(surface));
  return mesh;
}

/// Three whole numbers, in two dimensions two; nothing where the key is absent.
std::optional<Cell3> whole_numbers(TableReader& t, const std::string& key, int dimension,
                                   int least) {
  if (!t.has(key)) return std::nullopt;
  const Vec3 numbers = t.vector(key, dimension, "voxels");
  Cell3 cell{0, 0, dimension == 2 ? std::max(least, 0) : 0};
  for (int k = 0; k < dimension; ++k) {
    cell[k] = static_cast<int>(std::clamp(numbers[k], -1e9, 1e9));
    if (cell[k] != numbers[k] || cell[k] < least)
      t.fail(key, fmt::format("holds {}", numbers[k]),
             fmt::format("give whole numbers of at least {}", least));
  }
  return cell;
}

/// The part [from, to) of an image; of one slice in two dimensions.
GreyImage cut_out(TableReader& t, GreyImage image, Cell3 from, Cell3 to) {
  if (image.size[2] == 1) to[2] = 1;
  GreyImage part;
  for (int k = 0; k < 3; ++k) {
    part.size[k] = to[k] - from[k];
    if (part.size[k] < 1 || to[k] > image.size[k])
      t.fail("image",
             fmt::format(
                 "has {} voxels: {} {} and {} in {}", fmt::join(image.size, " × "),
                 part.size[k] < 1 ? "nothing lies between" : "they do not fill what is between",
                 from[k], to[k], "xyz"[k]),
             "correct cut_from and cut_to, in voxels");
  }
  if (part.size == image.size) return image;
  for (int z = from[2]; z < to[2]; ++z)
    for (int y = from[1]; y < to[1]; ++y)
      for (int x = from[0]; x < to[0]; ++x) part.levels.push_back(image.at(x, y, z));
  return part;
}

/// What levels of an image become, and what is to be said where all become the same.
struct FractionRule {
  std::function<float(float)> fraction;
  std::string key;
};

/// How levels become solid fractions.
FractionRule fraction_rule(TableReader& t) {
  const auto threshold = t.optional_number("threshold", {}, "");
  const bool above = t.choice_or("solid", "above", {"above", "below"}) == "above";
  const std::vector<double> levels = t.numbers_or("grey_levels", {}, {}, "");
  if (threshold.has_value() != levels.empty())
    t.fail("threshold", threshold ? "stands beside grey_levels" : "is missing",
           "give a threshold, or grey_levels = [of fluid, of solid]");
  if (threshold) {
    const double at = *threshold;
    return {[at, above](float v) { return (v >= at) == above ? 1.0F : 0.0F; }, "threshold"};
  }
  if (levels.size() != 2 || levels[0] == levels[1])
    t.fail("grey_levels", "is no pair of different levels",
           "give [of fluid, of solid]; where solid is dark, the first is the higher");
  if (t.has("solid"))
    t.fail("solid", "stands beside grey_levels, whose order says it",
           "leave it out; give grey_levels = [of fluid, of solid], the higher first where solid is "
           "dark");
  const double fluid = levels[0], slope = 1.0 / (levels[1] - levels[0]);
  return {[fluid, slope](float v) {
            return static_cast<float>(std::clamp((v - fluid) * slope, 0.0, 1.0));
          },
          "grey_levels"};
}

/// Refuses a rule by which an image of several levels is all fluid, or all solid.
void check_levels(const TableReader& t, const GreyImage& image, const FractionRule& rule) {
  const auto [low, high] = std::ranges::minmax(image.levels);
  const float first = rule.fraction(low), last = rule.fraction(high);
  if (low == high || first != last || (first != 0.0F && first != 1.0F)) return;
  t.fail(rule.key,
         fmt::format("makes all of the image {}: its levels are {:.6g} … {:.6g}",
                     first == 0.0F ? "fluid" : "solid", low, high),
         "give levels between these; a file of 16 bits has other numbers than one of 8");
}

/// Refuses keys of another kind of file.
void check_layout(TableReader& t, const std::string& path) {
  const std::string kind = image_kind(path);
  const std::string name = std::filesystem::path(path).filename().string();
  for (const char* key : {"raw_size", "raw_type"})
    if (t.has(key) && kind != ".raw")
      t.fail(key, "is for .raw files, and \"" + name + "\" says itself what it holds",
             "leave it out; a part of an image is cut with cut_from and cut_to");
  if (t.has("dataset") && kind != ".h5" && kind != ".hdf5")
    t.fail("dataset", "is for .h5 files, and \"" + name + "\" holds one array", "leave it out");
}

ImageScene read_image(TableReader& t, const std::string& scene_file, const BoxScene& box) {
  ImageScene scene;
  scene.voxel = t.number("voxel", Bounds::positive(), "m");
  scene.at = t.has("at") ? t.vector("at", box.dimension, "[m], the lower corner") : box.origin;
  const FractionRule rule = fraction_rule(t);
  ImageLayout layout;
  layout.raw_size = whole_numbers(t, "raw_size", box.dimension, 1).value_or(Cell3{0, 0, 0});
  layout.raw_type = t.text_or("raw_type", "");
  layout.dataset = t.text_or("dataset", "");
  const auto from = whole_numbers(t, "cut_from", box.dimension, 0);
  const auto to = whole_numbers(t, "cut_to", box.dimension, 0);
  const std::string path = file_of(t, "image", scene_file);
  scene.file = path;
  check_layout(t, path);
  GreyImage image = read_file(t, "image", path, [&] { return read_image(path, layout); });
  if (box.dimension == 2 && image.size[2] > 1)
    t.fail("image",
           image.size[0] <= 4  // red, green, blue and perhaps how opaque, of each pixel
               ? fmt::format("is an array of {} × {} × {} numbers, which looks like a picture with "
                             "colours, and the box has two dimensions",
                             image.size[2], image.size[1], image.size[0])
               : fmt::format("has {} slices, the box two dimensions", image.size[2]),
           image.size[0] <= 4 ? "make it grey, [y][x]: array.mean(axis=2)"
                              : "give one slice, or a box in three dimensions");
  check_levels(t, image, rule);
  image = cut_out(t, std::move(image), from.value_or(Cell3{0, 0, 0}), to.value_or(image.size));
  for (float& level : image.levels) level = rule.fraction(level);
  scene.voxels = std::make_shared<const Voxels>(Voxels{image.size, std::move(image.levels)});
  return scene;
}

/// A block that moves: the mesh of a box, in two dimensions a short piece of it around the middle
/// of the layer. (A solid program that repeats the layer would find ends at its borders in one
/// place, and LIGGGHTS wants triangles that are not too long.)
MeshScene box_mesh(Vec3 low, Vec3 high, const BoxScene& box) {
  if (box.dimension == 2) {
    high.z() = std::min(0.4 * box.depth, 0.5 * (high - low).maxCoeff());
    low.z() = -high.z();
  }
  TriangleMesh mesh = box_surface(low, high);
  MeshScene scene;
  scene.file = "of a block";
  scene.volume = enclosed_volume(mesh);
  scene.surface = std::make_shared<const TriangleMesh>(std::move(mesh));
  return scene;
}

/// A rod, or with `hollow` a bore, as a mesh.
MeshScene read_cylinder(TableReader& t, const BoxScene& box) {
  if (box.dimension == 2)
    t.fail("diameter", "stands beside from and to: a cylinder is there in three dimensions only",
           "give centre and diameter for a disc, or from and to for a block");
  const Vec3 from = t.vector("from", 3, "[m], the centre of an end of the cylinder");
  const Vec3 to = t.vector("to", 3, "[m], the centre of its other end");
  if (from == to) t.fail("to", "is equal to from", "give the centres of both ends of the cylinder");
  TriangleMesh surface =
      cylinder_surface(from, to, 0.5 * t.number("diameter", Bounds::positive(), "m"));
  MeshScene mesh;
  mesh.file = "of a cylinder";
  mesh.hollow = t.flag_or("hollow", false);
  if (const auto [low, high] = bounds(surface); !Reach(low, high, box).meets)
    t.fail("from", fmt::format("and to: the cylinder {}, outside of the box", reach_text(surface)),
           "correct from and to, the centres of its ends in m, or its diameter");
  mesh.volume = enclosed_volume(surface);
  mesh.surface = std::make_shared<const TriangleMesh>(std::move(surface));
  return mesh;
}

/// Its middle, about which it turns where nothing else is said.
Vec3 middle_of(const ObstacleScene& o) {
  if (o.round) return o.centre;
  const auto [low, high] = bounds(*o.mesh->surface);
  return 0.5 * (low + high);
}

void read_its_motion(TableReader& t, const std::string& scene_file, const BoxScene& box,
                     ObstacleScene& o) {
  std::optional<ReadMotion> read = read_motion(t, scene_file, box.dimension);
  if (!read) return;
  if (o.image)
    t.fail("motion", "is there for discs, spheres, blocks and meshes, not for images",
           "draw it as a mesh, or leave motion out");
  if (o.mesh && o.mesh->hollow)
    t.fail("hollow", "stands beside motion: the solid would reach to the sides of the box",
           "take a mesh that has both surfaces of the wall, or a mesh of one surface with a "
           "thickness");
  if (!o.spin.isZero(0.0))
    t.fail("spin", "stands beside motion", "give motion = \"rotation\" and angular_velocity");
  if (o.block()) {
    for (int k = 0; k < box.dimension; ++k)
      if (!(o.from[k] < o.to[k]))
        t.fail("to", fmt::format("is not above from in {}", "xyz"[k]),
               "give its lower and upper corner");
    o.mesh = box_mesh(o.from, o.to, box);
  }
  o.motion = std::move(read->motion);
  if (!read->has_pivot) o.motion->about = middle_of(o);
  if (box.dimension == 2) o.motion->about.z() = 0.0;
}

}  // namespace

ObstacleScene read_obstacle(TableReader t, const std::string& scene_file, const BoxScene& box) {
  ObstacleScene o{.where = t.place()};
  const int d = box.dimension;
  o.round = t.has("centre");
  if (t.has("mesh")) {
    o.round = false;
    o.mesh = read_mesh(t, scene_file, box);
  } else if (t.has("image")) {
    o.round = false;
    o.image = read_image(t, scene_file, box);
  } else if (!o.round && t.has("from") && t.has("diameter")) {
    o.mesh = read_cylinder(t, box);
  } else if (o.round) {
    o.centre = t.vector("centre", d, "[m]");
    o.diameter = t.number("diameter", Bounds::positive(), "m");
    o.hollow = t.flag_or("hollow", false);
    if (d == 3)
      o.spin = t.vector_or_zero("spin", 3, "[rad/s]");
    else
      o.spin.z() = t.number_or("spin", 0.0, {}, "rad/s");
  } else {
    o.from =
        t.vector("from", d, "[m], or centre and diameter of a disc or sphere, or a mesh or image");
    o.to = t.vector("to", d, "[m]");
  }
  read_its_motion(t, scene_file, box, o);
  t.finish();
  return o;
}

}  // namespace lbm
