// SPDX-License-Identifier: GPL-2.0-or-later
/// Meshes and images that a scene names as obstacles.
#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <numbers>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/image_file.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/io/stl_file.h"
#include "lbm_solver/solver/plan.h"
#include "tests/support/meshes.h"
#include "tests/unit/lbm_solver/scene_files.h"

namespace {

using namespace lbm;

class ObstacleFiles : public testing::Test {
 protected:
  /// A box of 8 × 8 (× 8) mm in cells of 1 mm with an obstacle.
  std::string scene(int dimension, const std::string& obstacle) const {
    const bool flat = dimension == 2;
    return folder_.write("scene.toml",
                         std::string("[box]\nsize = ") +
                             (flat ? "[0.008, 0.008]" : "[0.008, 0.008, 0.008]") +
                             "\n[fluid]\ndensity = 1000.0\nkinematic_viscosity = 1e-6\n"
                             "velocity_scale = 1e-4\n[numerics]\ncell = 0.001\n"
                             "[run]\nend_time = 1.0\n[[obstacle]]\n" +
                             obstacle);
  }
  Scene read(int dimension, const std::string& obstacle) const {
    return read_scene({scene(dimension, obstacle)});
  }
  void refused(int dimension, const std::string& obstacle,
               const std::vector<std::string>& words) const {
    try {
      const Scene s = read(dimension, obstacle);
      make_fluid(s, make_plan(s));
      ADD_FAILURE() << "accepted: " << obstacle;
    } catch (const InputError& e) {
      for (const std::string& word : words)
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos)
            << word << " not in: " << e.what();
    }
  }
  std::string mesh(TriangleMesh surface) const {
    write_stl(folder_.path() + "/mesh.stl", surface);
    return "mesh = \"mesh.stl\"\n";
  }
  test::TemporaryFolder folder_;
};

const Vec3 kLow(0.002, 0.003, 0.001), kHigh(0.006, 0.005, 0.007);

TEST_F(ObstacleFiles, AMeshIsScaledTurnedAndMoved) {
  const std::string key = mesh(test::box_mesh({0, 0, 0}, {1, 2, 3}));
  const Scene s =
      read(3, key + "scale = 0.001\nrotate = [0, 0, 1, 90]\nmove = [0.006, 0.002, 0.001]");
  const auto [low, high] = bounds(*s.obstacles[0].mesh->surface);
  EXPECT_LT((low - Vec3(0.004, 0.002, 0.001)).norm(), 1e-12);
  EXPECT_LT((high - Vec3(0.006, 0.003, 0.004)).norm(), 1e-12);
  EXPECT_NEAR(s.obstacles[0].mesh->volume, 6e-9, 1e-20);
}

TEST_F(ObstacleFiles, ACylinderLiesBetweenItsEndsAndHasTheVolumeOfARoundOne) {
  const Scene s =
      read(3, "from = [0.002, 0.002, 0.004]\nto = [0.006, 0.005, 0.004]\ndiameter = 0.002");
  const MeshScene& mesh = *s.obstacles[0].mesh;
  const double exact = std::numbers::pi * 1e-6 * 0.005;
  EXPECT_NEAR(mesh.volume, exact, 1e-12 * exact);
  EXPECT_NEAR(enclosed_volume(*mesh.surface), exact, 1e-12 * exact);
  const auto [low, high] = bounds(*mesh.surface);
  // the ends are circles across (4, 3, 0) mm
  EXPECT_LT((low - Vec3(0.002 - 0.0006, 0.002 - 0.0008, 0.003)).norm(), 2e-7);
  EXPECT_LT((high - Vec3(0.006 + 0.0006, 0.005 + 0.0008, 0.005)).norm(), 2e-7);
  EXPECT_EQ(defects(*mesh.surface).open + defects(*mesh.surface).turned, 0U);
}

TEST_F(ObstacleFiles, ACylinderThatIsNoneIsRefused) {
  refused(2, "from = [0.002, 0.002]\nto = [0.006, 0.005]\ndiameter = 0.002",
          {"obstacle.diameter", "in three dimensions only", "centre and diameter for a disc"});
  refused(3, "from = [0.002, 0.002, 0.004]\nto = [0.002, 0.002, 0.004]\ndiameter = 0.002",
          {"obstacle.to", "equal to from"});
  refused(
      3, "from = [0.02, 0.02, 0.04]\nto = [0.02, 0.02, 0.05]\ndiameter = 0.002",
      {"obstacle.from", "the cylinder reaches from", "outside of the box", "correct from and to"});
}

TEST_F(ObstacleFiles, AnAsciiAndABinaryMeshAreTheSame) {
  const TriangleMesh ball = test::sphere_mesh({0.004, 0.004, 0.004}, 0.003, 2);
  const Scene ascii = read(3, mesh(ball));
  std::string bytes(80, ' ');
  const auto add = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  add(static_cast<std::uint32_t>(ball.triangles.size()));
  for (const auto& t : ball.triangles) {
    for (int k = 0; k < 3; ++k) add(0.0F);
    for (const auto v : t)
      for (int k = 0; k < 3; ++k) add(static_cast<float>(ball.vertices[v][k]));
    add(std::uint16_t{0});
  }
  folder_.write("binary.stl", bytes);
  const Scene binary = read(3, "mesh = \"binary.stl\"");
  const auto &a = *ascii.obstacles[0].mesh, &b = *binary.obstacles[0].mesh;
  EXPECT_EQ(a.surface->triangles, b.surface->triangles);
  EXPECT_NEAR(a.volume, b.volume, 1e-6 * a.volume);
  folder_.write("binary.stl", bytes.substr(0, bytes.size() - 7));
  refused(3, "mesh = \"binary.stl\"", {"its header announces 320 facets", "whole .stl file"});
}

TEST_F(ObstacleFiles, ABadMeshIsDescribed) {
  const TriangleMesh box = test::box_mesh(kLow, kHigh);
  TriangleMesh bad = box;
  bad.triangles.pop_back();
  refused(3, mesh(bad), {"3 of its edges are open", "(0.006, 0.003, 0.004) m", "thickness"});
  bad = box;
  std::swap(bad.triangles[0][0], bad.triangles[0][1]);
  refused(3, mesh(bad), {"3 of its edges lie between triangles that face opposite ways"});
  for (auto& t : (bad = box).triangles) std::swap(t[1], t[2]);
  refused(3, mesh(bad), {"face inwards"});
  refused(3, mesh(test::box_mesh(1e3 * kLow, 1e3 * kHigh)), {"750 times the box", "scale = 0.001"});
  refused(3, mesh(test::box_mesh(1e3 * kLow, 1e3 * kHigh)) + "scale = 0.9",
          {"is its file in mm? with scale = 0.001 it would reach from (0.002, 0.003, 0.001) m"});
  refused(3, mesh(test::box_mesh(kLow / 0.0254, kHigh / 0.0254)) + "scale = 0.1",
          {"outside of the box", "or is its file in inches? with scale = 0.0254"});
  refused(3, mesh(box) + "scale = 0.001",
          {"the 1. obstacle's mesh", "no cell sees it", "in m? with scale = 1"});
  refused(3, mesh(box) + "move = [0.1, 0, 0]", {"outside of the box", "give move"});
  refused(2, mesh(box), {"three dimensions only", "as an image"});
  refused(3, mesh(box) + "rotate = [0, 0, 0, 30]", {"no axis and angle"});
  refused(3, mesh(box) + "[[obstacle]]\nmesh = \"other.stl\"", {"other.stl", "beside the scene"});
  std::string text = test::read_file(folder_.path() + "/mesh.stl");
  folder_.write("mesh.stl", test::replaced(text, "vertex 0.002", "vertex nan"));
  refused(3, "mesh = \"mesh.stl\"", {"facet 1 has a corner at (nan"});
  folder_.write("mesh.stl", test::replaced(text, "vertex 0.002", "vertex 0,002"));
  refused(3, "mesh = \"mesh.stl\"", {"line 4", "is no vertex"});
  folder_.write("mesh.stl", "solid empty\nendsolid\n");
  refused(3, "mesh = \"mesh.stl\"", {"mesh.stl", "no 'facet'"});
}

TEST_F(ObstacleFiles, AnOpenSurfaceNeedsAThickness) {
  const TriangleMesh plate{{{-1, -1, 0.0042}, {1, -1, 0.0042}, {1, 1, 0.0042}, {-1, 1, 0.0042}},
                           {{0, 1, 2}, {0, 2, 3}}};
  refused(3, mesh(plate) + "scale = 0.1", {"holes"});
  const Scene s = read(3, mesh(plate) + "scale = 0.1\nmove = [0, 0, 0.004]\nthickness = 0.003");
  EXPECT_NEAR(s.obstacles[0].mesh->volume, 0.2 * 0.2 * 0.003, 1e-12);
}

TEST_F(ObstacleFiles, NoParticleStartsInAMesh) {
  const std::string particles =
      "\n[particles]\ndiameter = 0.001\ndensity = 2500.0\nstart = [[0.004, 0.004, 0.0045]]\n";
  const std::string ball = mesh(test::sphere_mesh({0.004, 0.004, 0.004}, 0.002, 2));
  refused(3, ball + particles,
          {"particles.start: [0.004, 0.004, 0.0045] lies in an obstacle's mesh"});
  const Scene beside = read(3, ball + test::replaced(particles, "0.0045", "0.0065"));
  EXPECT_EQ(make_plan(beside).domain.nz, 8);
}

/// Bytes 0 … n-1 as an image of so many voxels.
std::string bytes(int n) {
  std::string all;
  for (int k = 0; k < n; ++k) all += static_cast<char>(k);
  return all;
}

constexpr const char* kRaw =
    "image = \"rock.raw\"\nraw_size = [4, 3, 2]\nraw_type = \"uint8\"\nvoxel = 0.001\n";

TEST_F(ObstacleFiles, ARawImageIsReadAndPlaced) {
  folder_.write("rock.raw", bytes(24));
  const Scene s = read(3, std::string(kRaw) + "threshold = 20\nat = [0.002, 0.001, 0.003]");
  const ImageScene& image = *s.obstacles[0].image;
  EXPECT_EQ(image.voxels->size, (Cell3{4, 3, 2}));
  EXPECT_EQ(image.voxels->solid[19], 0.0F);
  EXPECT_EQ(image.voxels->solid[20], 1.0F);
  const Fluid fluid = make_fluid(s, make_plan(s));
  EXPECT_EQ(fluid.solid_fraction(2, 3, 4), 1.0);  // voxel 20 = (0, 2, 1)
  EXPECT_EQ(fluid.solid_fraction(5, 2, 4), 0.0);
  const Scene below = read(3, std::string(kRaw) + "threshold = 20\nsolid = \"below\"");
  EXPECT_EQ(below.obstacles[0].image->voxels->solid[19], 1.0F);
  const Scene grey = read(3, std::string(kRaw) + "grey_levels = [20, 10]");
  EXPECT_EQ(grey.obstacles[0].image->voxels->solid[5], 1.0F);
  EXPECT_NEAR(grey.obstacles[0].image->voxels->solid[17], 0.3, 1e-7);
  refused(3, std::string(kRaw) + "grey_levels = [20, 10]\nsolid = \"below\"",
          {"solid stands beside grey_levels", "the higher first where solid is dark"});
  const Scene cut =
      read(3, std::string(kRaw) + "threshold = 20\ncut_from = [1, 2, 1]\ncut_to = [3, 3, 2]");
  EXPECT_EQ(cut.obstacles[0].image->voxels->size, (Cell3{2, 1, 1}));
}

TEST_F(ObstacleFiles, ABadImageIsDescribed) {
  folder_.write("rock.raw", bytes(25));
  const std::string raw = std::string(kRaw) + "threshold = 20\n";
  refused(3, raw, {"has 25 bytes, but 4 × 3 × 2 voxels of uint8 are 24", "raw_size or raw_type"});
  folder_.write("rock.raw", bytes(24));
  refused(3, test::replaced(raw, "uint8", "short"), {"give raw_size", "uint16"});
  refused(3, kRaw, {"threshold is missing", "grey_levels"});
  refused(3, raw + "grey_levels = [0, 1]", {"stands beside grey_levels"});
  refused(3, raw + "at = [0.006, 0, 0]", {"takes cells 6 … 10 along x, the box has 8"});
  refused(3, raw + "cut_to = [5, 3, 2]", {"they do not fill what is between 0 and 5 in x"});
  refused(3, test::replaced(raw, "voxel = 0.001", "voxel = 0.0015"),
          {"scene.toml:", ": obstacle.voxel = 0.0015 m is 1.5 cells"});
  for (const char* voxel : {"voxel = 5e-30", "voxel = 5e-300", "voxel = 1e30"})
    refused(3, test::replaced(raw, "voxel = 0.001", voxel), {"cells", "10000 at most"});
  refused(3, test::replaced(raw, "voxel = 0.001", "voxel = 0.0005"),
          {"obstacle.image: has 3 voxels along y, and 2 of them make a cell"});
  folder_.write("rock.JPG", "no picture");
  refused(3, "image = \"rock.JPG\"\nvoxel = 1\nthreshold = 1",
          {"\"rock.JPG\" is of a kind that is not read (.jpg)",
           "PIL.Image.open(\"rock.JPG\").convert(\"L\").save(\"rock.png\")"});
  refused(2, test::replaced(raw, "[4, 3, 2]", "[4, 6]") + "cut_to = [9, 6]",
          {"they do not fill what is between"});
  folder_.write("rock.npy", "no array");
  refused(3, "image = \"rock.npy\"\nvoxel = 0.001\nthreshold = 1", {"is no .npy file"});
  refused(3, raw + "dataset = \"/rock\"", {"dataset is for .h5 files"});
  refused(3, test::replaced(raw, "rock.raw", "rock.npy"),
          {"raw_size is for .raw files", "\"rock.npy\" says itself what it holds"});
  refused(3, test::replaced(raw, "= 20", "= 200"),
          {"threshold makes all of the image fluid", "its levels are 0 … 23"});
  refused(3, test::replaced(raw, "= 20", "= 0"), {"makes all of the image solid"});
  refused(3, std::string(kRaw) + "grey_levels = [100, 200]",
          {"grey_levels makes all of the image fluid"});
  folder_.write("rock.png", "no picture");
  refused(2, "image = \"rock.png\"\nvoxel = 0.001\nthreshold = 1", {"rock.png"});
  folder_.write("rock.tif", "no picture");
  refused(2, "image = \"rock.tif\"\nvoxel = 0.001\nthreshold = 1", {"rock.tif"});
}

/// All warnings of a scene, a line each.
std::string warnings_of(const Scene& s) {
  std::string all;
  for (const std::string& w : make_plan(s).warnings) all += w + "\n";
  return all;
}

TEST_F(ObstacleFiles, AMeshWithAnotherScaleThanThatOfItsUnitIsNamed) {
  const std::string key = mesh(test::box_mesh({0, 0, 0}, {4, 4, 6}));
  EXPECT_EQ(warnings_of(read(3, key + "scale = 0.001")), "");
  EXPECT_NE(
      warnings_of(read(3, key + "scale = 0.01")).find("is its file in mm? with scale = 0.001"),
      std::string::npos);
  // one that is long, as a pipe through the box, would not lie in it by another unit
  EXPECT_EQ(warnings_of(read(3, mesh(test::box_mesh({-0.05, 0.002, 0.002}, {0.05, 0.006, 0.006})))),
            "");
}

TEST_F(ObstacleFiles, ThatLieInEachOtherAreNamed) {
  const std::string ball = mesh(test::sphere_mesh({0.004, 0.004, 0.004}, 0.003, 2));
  const auto said = [&](const std::string& obstacle) {
    return warnings_of(read(3, ball + "[[obstacle]]\n" + obstacle));
  };
  const std::string block = "from = [0.005, 0.0, 0.0]\nto = [0.008, 0.008, 0.008]\n";
  EXPECT_NE(said(block).find("the 2. obstacle overlaps the 1., and the 2. is a block: the load "
                             "on cells of both counts for both"),
            std::string::npos);
  EXPECT_EQ(said("from = [0.007, 0.0, 0.0]\nto = [0.008, 0.008, 0.008]\n"), "");  // touches
  EXPECT_NE(said("centre = [0.006, 0.004, 0.004]\ndiameter = 0.004\n").find("overlaps the 1.: the"),
            std::string::npos);
  EXPECT_EQ(said("centre = [0.004, 0.004, 0.004]\ndiameter = 0.0075\nhollow = true\n"), "");
  const auto of_blocks = [&](const std::string& first, const std::string& second) {
    return warnings_of(read(3, first + "[[obstacle]]\n" + second));
  };
  EXPECT_NE(of_blocks(block, block).find("the 2. obstacle lies wholly in the 1., and no fluid"),
            std::string::npos);
  const std::string slab = "from = [0.006, 0.0, 0.0]\nto = [0.008, 0.008, 0.008]\n";
  EXPECT_NE(of_blocks(slab, block).find("the 1. obstacle lies wholly in the 2."),
            std::string::npos);
  EXPECT_EQ(of_blocks(block, "from = [0.0, 0.0, 0.0]\nto = [0.006, 0.002, 0.008]\n"), "");
  // a ball before the block, and a ball that is a mesh beside it
  EXPECT_NE(of_blocks("centre = [0.004, 0.004, 0.004]\ndiameter = 0.006\n", block)
                .find("overlaps the 1., and the 2. is a block"),
            std::string::npos);
}

TEST_F(ObstacleFiles, AnImageThatLeavesAGapIsNamed) {
  folder_.write("rock.raw", bytes(24));
  const std::string raw = std::string(kRaw) + "threshold = 20\n";
  EXPECT_NE(warnings_of(read(3, raw))
                .find("the image of the 1. obstacle fills 0.004 of 0.008 m along x, 0.003 of"),
            std::string::npos);
  EXPECT_EQ(warnings_of(read(3, raw + "at = [0, 0, 0]")), "");
}

// A wall of voxels across x with a gap at (4, 7), or where that is closed none.
TEST_F(ObstacleFiles, AnImageWithoutAWayForTheFlowIsNamed) {
  std::string levels(64, '\0');
  for (int y = 0; y < 8; ++y) levels[8 * y + 4] = '\1';
  const std::string keys =
      "image = \"rock.raw\"\nraw_size = [8, 8]\nraw_type = \"uint8\"\nvoxel = 0.001\n"
      "threshold = 1\n";
  const auto said = [&](const std::string& voxels, const std::string& axis) {
    folder_.write("rock.raw", voxels);
    const std::string text = test::read_file(scene(2, keys));
    return warnings_of(read_scene({folder_.write(
        "scene.toml",
        test::replaced(
            text, "\n[fluid]",
            "\nsides_x = \"periodic\"\nsides_y = \"periodic\"\n[fluid]\nbody_force = " + axis))}));
  };
  EXPECT_NE(said(levels, "[1e-3, 0]").find("obstacles close the box along x, and fluid.body_force"),
            std::string::npos);
  EXPECT_EQ(said(levels, "[0, 1e-3]").find("close the box"), std::string::npos);
  std::string open = levels;
  open[8 * 7 + 4] = '\0';
  EXPECT_EQ(said(open, "[1e-3, 0]").find("the only way"), std::string::npos);
  // (3, 6) and (4, 7) are open, and the two cells between them covered
  std::string corner = open;
  corner[8 * 7 + 3] = '\1';
  corner[8 * 0 + 3] = '\1';
  EXPECT_NE(said(corner, "[1e-3, 0]").find("the only way leads between covered cells that touch"),
            std::string::npos);
  corner[8 * 6 + 3] = '\1';
  EXPECT_NE(said(corner, "[1e-3, 0]").find("obstacles close the box along x"), std::string::npos);
}

/// A .npy file. @param descr  e.g. <f4
std::string npy(const std::string& descr, const std::string& shape, const std::string& data) {
  std::string header =
      "{'descr': '" + descr + "', 'fortran_order': False, 'shape': " + shape + ", }";
  header.resize(118, ' ');
  return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(118) + '\0' + header + data;
}

TEST_F(ObstacleFiles, AnArrayOfNumpyIsRead) {
  const float levels[] = {0.0F, 0.25F, 0.5F, 1.0F, 0.75F, 0.0F};
  const std::string data(reinterpret_cast<const char*>(levels), sizeof levels);
  const std::string keys = "image = \"rock.npy\"\nvoxel = 0.001\ngrey_levels = [0, 1]";
  folder_.write("rock.npy", npy("<f4", "(2, 3)", data));
  const Scene s = read(2, keys);
  EXPECT_EQ(s.obstacles[0].image->voxels->size, (Cell3{3, 2, 1}));
  EXPECT_EQ(s.obstacles[0].image->voxels->solid[4], 0.75F);
  std::string swapped = data;
  for (std::size_t k = 0; k < data.size(); k += 4) std::reverse(&swapped[k], &swapped[k] + 4);
  folder_.write("rock.npy", npy(">f4", "(2, 3)", swapped));
  EXPECT_EQ(read(2, keys).obstacles[0].image->voxels->solid, s.obstacles[0].image->voxels->solid);
  folder_.write("rock.npy", npy("<c8", "(2, 3)", data + data));
  refused(2, keys, {"numbers of type '<c8'", "float32"});
  folder_.write("rock.npy", npy("<f4", "(2, 4)", data));
  refused(2, keys, {"has 24 bytes of data where 32 are due"});
  folder_.write("rock.npy", npy("<f4", "(2, 1, 3)", data));
  refused(2, keys, {"array of 2 × 1 × 3 numbers", "a picture with colours", "mean(axis=2)"});
  folder_.write("rock.npy", npy("<f4", "(6,)", data));
  refused(2, keys, {"array of 1 dimensions, of shape (6)", "[y][x] or [z][y][x]"});
  folder_.write("rock.npy", npy("<f4", "(1, 1, 2, 3)", data));
  refused(3, keys, {"of 4 dimensions, of shape (1, 1, 2, 3): colours", "array.mean(axis=3)"});
  folder_.write("rock.npy", npy("<f4", "(8, 8, 3)", std::string(8 * 8 * 3 * 4, '\1')));
  EXPECT_NE(warnings_of(read(3, keys)).find("shape (8, 8, 3), is that [y][x][colour]?"),
            std::string::npos);
  const float nan[] = {0.0F, 0.25F, 0.5F, 1.0F, std::nanf(""), 0.0F};
  folder_.write("rock.npy", npy("<f4", "(2, 3)", {reinterpret_cast<const char*>(nan), sizeof nan}));
  refused(2, keys, {"is nan at voxel [1, 1, 0]"});
}

/// Of the pictures beside this test: [10 20 30; 40 50 60], its first row on top.
std::vector<float> picture(const std::string& name) {
  const std::string folder = BPLBM_SOURCE_DIR "/tests/unit/lbm_solver/pictures/";
  return read_image(folder + name, ImageLayout{}).levels;
}

TEST(Pictures, AreTakenAsTheyAreSeen) {
  try {
    EXPECT_EQ(picture("grey8.png"), (std::vector<float>{40, 50, 60, 10, 20, 30}));
    EXPECT_EQ(picture("grey16.png")[5], 30.0F * 257.0F);
    EXPECT_THROW(picture("colour.png"), std::invalid_argument);
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("built without libpng"), std::string::npos) << e.what();
  }
}

TEST(Pictures, MayBeStacks) {
  try {
    const std::vector<float> stack = picture("stack.tif");
    EXPECT_EQ(stack.size(), 12U);
    EXPECT_EQ(stack[3], 10.0F);
    EXPECT_EQ(stack[6], 140.0F);  // the second page is above
    EXPECT_EQ(picture("real.tif")[3], 0.1F);
    EXPECT_EQ(picture("bits.tif"), (std::vector<float>{1, 0, 0, 0, 1, 1}));
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("built without libtiff"), std::string::npos) << e.what();
  }
}

TEST_F(ObstacleFiles, LinksAndMarkersKnowNoMeshes) {
  const std::string file = scene(3, mesh(test::box_mesh(kLow, kHigh)));
  const std::string text = test::read_file(file);
  folder_.write("scene.toml",
                test::replaced(text, "cell = 0.001", "cell = 0.001\nscheme = \"bounce_back\""));
  try {
    make_plan(read_scene({file}));
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("no meshes and images"), std::string::npos) << e.what();
  }
}

}  // namespace
