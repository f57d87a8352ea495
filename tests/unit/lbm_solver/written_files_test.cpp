// SPDX-License-Identifier: GPL-2.0-or-later
/// What a run writes names its columns and units, lies where it should, and holds no "nan".
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "lbm_solver/coupling/observers.h"
#include "lbm_solver/coupling/report.h"
#include "lbm_solver/io/scene_reader.h"
#include "protocol/transport/hdf5_file.h"
#include "tests/support/job.h"

namespace {

using namespace lbm;
using protocol::hdf5::Handle;
using test::read_file;

std::string attribute(const std::string& file, const std::string& array, const std::string& name) {
  const Handle f = protocol::hdf5::open_file(file, protocol::hdf5::Open::Read);
  const Handle set(H5Dopen2(f, array.c_str(), H5P_DEFAULT), H5Dclose, "open " + array);
  return protocol::hdf5::text_attribute(set, name);
}

std::vector<double> numbers(const std::string& file, const std::string& array) {
  const Handle f = protocol::hdf5::open_file(file, protocol::hdf5::Open::Read);
  const Handle set(H5Dopen2(f, array.c_str(), H5P_DEFAULT), H5Dclose, "open " + array);
  const Handle space(H5Dget_space(set), H5Sclose, "space");
  std::vector<double> all(H5Sget_simple_extent_npoints(space));
  H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data());
  return all;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++n;
  return n;
}

protocol::Particle grain(std::int64_t id, double x, double y, double radius = 0.01) {
  return {{id, {x, y, 0.0}, {0.1, 0.2, 0.0}, {0.0, 0.0, 3.0}}, {id, radius, 1.0, 1e-4, 2}};
}

/// A box of as many cells as the frames below have.
Decomposition small_box(int dimension) {
  return Decomposition(Domain{3, 2, Side::Wall, Side::Wall, dimension == 3 ? 2 : 1});
}

FieldFrame small_frame(int dimension) {
  FieldFrame f;
  f.cells.fields = {{"pressure", "Pa", 1}, {"velocity", "m/s", 3}, {"solid_fraction", "1", 1}};
  f.cells.make = [](const CellRange& piece, std::span<float> to) {
    std::ranges::fill(to, 0.0F);
    std::ranges::fill(to.first(piece.count()), 1.0F);
    std::ranges::fill(to.subspan(piece.count(), 3 * piece.count()), 0.5F);
  };
  f.particles = {grain(7, 0.02, 0.03), grain(9, 0.04, 0.03)};
  f.loads = {{7, {1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}}, {9, {7.0, 8.0, 9.0}, {0.0, 0.0, 0.1}}};
  f.bond_ends.assign(2 * dimension, 0.02);
  f.bond_state = {1.0};
  return f;
}

// A table has as many columns as names and as units, in both numbers of dimensions.
TEST(FieldWriter, NamesColumnsAndUnits) {
  for (const int dimension : {2, 3}) {
    const test::TemporaryFolder folder;
    FieldWriter writer(folder.path(), {0.01, 0.1, 1000.0, 1.0, {0.0, 0.0, 0.0}}, dimension);
    writer.write(small_frame(dimension), small_box(dimension));
    EXPECT_EQ(numbers(folder.path() + "/fields.h5", "/frame000000/velocity"),
              std::vector<double>(dimension == 3 ? 36 : 18, 0.5));
    const std::string file = folder.path() + "/fields.h5", frame = "/frame000000/";
    const std::string columns = attribute(file, frame + "particles", "columns");
    const std::size_t width = numbers(file, frame + "particles").size() / 2;
    EXPECT_EQ(columns.substr(0, 7), "id,x,y,");
    EXPECT_EQ(count(columns, ",") + 1, width);
    EXPECT_EQ(count(attribute(file, frame + "particles", "units"), ",") + 1, width);
    for (const auto& [array, unit] : std::map<std::string, std::string>{
             {"pressure", "Pa"},
             {"velocity", "m/s"},
             {"solid_fraction", "1"},
             {"bond_ends", "m"},
             {"bond_state", "1: 0 intact, 1 broken by tension, 2 by shear"},
             {"particle_id", "1"},
             {"particle_places", "m"},
             {"particle_radius", "m"},
             {"particle_velocity", "m/s"},
             {"particle_angular_velocity", "rad/s"},
             {"particle_force", "N"},
             {"particle_torque", "N m"}})
      EXPECT_EQ(attribute(file, frame + array, "unit"), unit) << array;
    EXPECT_EQ(numbers(file, frame + "particle_id"), (std::vector{7.0, 9.0}));
    EXPECT_EQ(numbers(file, frame + "particle_force"), (std::vector{1.0, 2.0, 3.0, 7.0, 8.0, 9.0}));
    EXPECT_EQ(numbers(file, frame + "particle_torque")[5], 0.1);
    EXPECT_EQ(numbers(file, frame + "particle_angular_velocity")[2], 3.0);
  }
}

// ParaView's readers put a 2DCoRectMesh into the y-z plane, and particles into x-y.
TEST(FieldWriter, ShowsFluidAndParticlesInOnePlace) {
  const test::TemporaryFolder folder;
  FieldWriter writer(folder.path(), {0.01, 0.1, 1000.0, 1.0, {0.5, 0.25, 0.0}});
  writer.write(small_frame(2), small_box(2));
  const std::string text = read_file(folder.path() + "/fields.xdmf");
  EXPECT_EQ(text.find("2DCoRectMesh"), std::string::npos);
  EXPECT_NE(text.find(R"(TopologyType="3DCoRectMesh" Dimensions="2 3 4")"), std::string::npos)
      << text;
  EXPECT_NE(text.find(">-0.01 0.25 0.5</DataItem>"), std::string::npos) << text;  // z, y, x
  EXPECT_NE(text.find(">0.01 0.01 0.01</DataItem>"), std::string::npos) << text;
  EXPECT_NE(text.find(R"(Dimensions="1 2 3">fields.h5:/frame000000/pressure)"), std::string::npos);
  EXPECT_NE(text.find(R"(Dimensions="1 2 3 3">fields.h5:/frame000000/velocity)"),
            std::string::npos);
  for (const char* value :
       {"id", "type", "radius", "velocity", "angular_velocity", "force", "torque"})
    EXPECT_NE(text.find(std::string("<Attribute Name=\"") + value + "\""), std::string::npos)
        << value;
}

TEST(FieldWriter, SaysThatItsFolderIsGone) {
  const test::TemporaryFolder folder;
  FieldWriter writer(folder.path(), {0.01, 0.1, 1000.0, 1.0, {0.0, 0.0, 0.0}});
  writer.write(small_frame(2), small_box(2));
  std::filesystem::rename(folder.path(), folder.path() + "-elsewhere");
  try {
    writer.write(small_frame(2), small_box(2));
    ADD_FAILURE() << "nothing was said";
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("its folder has been moved or deleted"),
              std::string::npos)
        << error.what();
  }
  std::filesystem::rename(folder.path() + "-elsewhere", folder.path());
}

TEST(Summary, SaysWhatProgramsThatComputeAtOnceWouldSave) {
  Summary s;
  s.wall_seconds = 10.0;
  const auto expect = [&](double waits, bool overlapped, const char* words, bool said) {
    s.time_share["waiting"] = waits;
    s.overlapped = overlapped;
    EXPECT_EQ(describe(s).find(words) != std::string::npos, said) << describe(s);
  };
  expect(0.3, false, "would save up to 30 %", true);
  expect(0.7, false, "would save up to 30 %", true);  // the fluid's own share
  expect(0.3, true, "waits 30 % of its time for the solid", true);
  expect(0.3, true, "overlapped", false);
  expect(0.15, false, "hint", false);
  expect(0.02, false, "more cores go to the fluid", true);
  s.time_share["exchange"] = 0.84;  // a machine that is busy with other work
  expect(0.02, false, "hint", false);
}

TEST(Summary, NamesTheUnitOfEveryNumber) {
  Summary s;
  s.time_share["sweep"] = 1.0;
  s.megabytes["populations"] = 2.0;
  s.peak_megabytes["first_rank"] = 3.0;
  s.writing["fields"] = 0.1;
  s.parameters = {{"cell", 1e-4}, {"tau", 0.8}};
  s.solid = protocol::SolidReport{3, protocol::BondCounts{10, 4, 3, 2, 1}, {}};
  const test::TemporaryFolder folder;
  write_summary(folder.path(), s);
  const auto json = nlohmann::json::parse(read_file(folder.path() + "/summary.json"));
  for (const auto& [name, value] : json.items()) {
    const bool group = value.is_object() && name != "units" && name != "versions";
    if (value.is_number() || group) {
      EXPECT_TRUE(json["units"].contains(name)) << name;
    }
  }
  EXPECT_EQ(json["units"]["physical_seconds"], "s");
  EXPECT_EQ(json["units"]["parameters"]["cell"], "m");
  EXPECT_EQ(json["grains"]["left"], 3);
  EXPECT_EQ(json["bonds"],
            nlohmann::json::parse(R"({"intact":10,"tension":4,"shear":3,"left":2,"lost":1})"));
  EXPECT_THROW(unit_of("no such number"), std::out_of_range);
}

TEST(CsvWriter, LeavesAFieldEmptyWhereThereIsNoNumber) {
  const test::TemporaryFolder folder;
  CsvWriter table(folder.path() + "/t.csv", "time [s],pressure [Pa],ux [m/s]");
  table.row({0.5, std::numeric_limits<double>::quiet_NaN(), 2.0});
  table.flush();
  EXPECT_EQ(read_file(folder.path() + "/t.csv"), "time [s],pressure [Pa],ux [m/s]\n0.5,,2\n");
}

/// A box of 0.1 × 0.1 m, periodic along x, whose grains and bonds a test sets.
class WatchedGrains : public testing::Test {
 protected:
  void write(const std::vector<protocol::Particle>& grains,
             const std::vector<protocol::Bond>& bonds) {
    const Scene scene = read_scene({folder_.write("scene.toml", R"(
[box]
size = [0.1, 0.1]
sides_x = "periodic"
[fluid]
density = 1000.0
kinematic_viscosity = 1e-4
velocity_scale = 0.5
[particles]
diameter = 0.02
density = 2000.0
[numerics]
cell = 0.005
[coupling]
[run]
end_time = 1.0
[output]
fields_every = 0.5
points = [[0.05, 0.05]]
)")});
    const Plan plan = make_plan(scene);
    const Decomposition ranks(plan.domain);
    Fluid fluid = make_fluid(scene, plan);
    Particles particles(plan.units, scene, ranks, plan.kernel.solid_term);
    particles.arrive(grains, plan.interval());
    particles.tell(protocol::SolidReport{0, protocol::BondCounts{1, 1, 0, 0, 0}, bonds});
    fluid.place(particles.bodies(0.0));
    Log log;
    Observers(scene, plan, ranks, folder_.path(), log).at_state(0, fluid, &particles, true);
  }
  std::string file(const std::string& name) const { return read_file(folder_.path() + "/" + name); }
  std::vector<double> array(const std::string& name) const {
    return numbers(folder_.path() + "/fields.h5", "/frame000000/" + name);
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(WatchedGrains, AreWrittenInsideThePeriodicBox) {
  write({grain(1, -2e-4, 0.05), grain(2, 0.1003, 0.05), grain(3, 0.05, 0.0999)}, {});
  std::istringstream table(file("probes.csv"));
  std::string line;
  std::getline(table, line);
  std::vector<double> x;
  while (std::getline(table, line)) {
    double id = 0.0, place = 0.0;
    std::sscanf(line.c_str(), "%*[^,],%lf,%lf", &id, &place);
    x.push_back(place);
  }
  ASSERT_EQ(x.size(), 3U);
  EXPECT_NEAR(x[0], 0.0998, 1e-12);
  EXPECT_NEAR(x[1], 0.0003, 1e-12);
  EXPECT_EQ(x[2], 0.05);
  EXPECT_NEAR(array("particle_places")[0], 0.0998, 1e-12);
}

// Radius 10 mm: two touch at 20 mm; parted by half of that a broken bond is no line any more.
TEST_F(WatchedGrains, ShowBrokenBondsOnlyWhileTheyAreNear) {
  write({grain(1, 0.02, 0.02), grain(2, 0.045, 0.02), grain(3, 0.08, 0.02), grain(4, 0.045, 0.05)},
        {{1, 2, 1}, {2, 3, 1}, {2, 4, 0}});
  EXPECT_EQ(array("bond_state"), (std::vector{1.0, 0.0}));
}

TEST_F(WatchedGrains, ATableHoldsNoNan) {
  write({grain(1, 0.05, 0.05)}, {});  // covers the point whole
  for (const char* name : {"probes.csv", "points.csv"})
    EXPECT_EQ(file(name).find("nan"), std::string::npos) << file(name);
  EXPECT_EQ(file("points.csv").substr(0, 31), "time [s],x [m],y [m],pressure [");
  EXPECT_NE(file("points.csv").find("0,0.05,0.05,,"), std::string::npos) << file("points.csv");
}

}  // namespace
