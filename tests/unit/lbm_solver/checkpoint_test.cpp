// SPDX-License-Identifier: GPL-2.0-or-later
/// Checkpoints as files: what is written is read, and nothing else is.
#include "lbm_solver/io/checkpoint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/coupling/restart.h"
#include "lbm_solver/io/scene_reader.h"
#include "protocol/program/solid_parts.h"
#include "tests/support/job.h"

namespace {

using namespace lbm;
namespace fs = std::filesystem;

Record sample() {
  Record inner, record;
  inner.set("ids", std::vector<std::int64_t>{1, -7, (std::int64_t{3} << 60) + 1});
  inner.set("none", std::vector<double>{});
  record.set("part", inner);
  record.set("list", std::vector<double>{0.1, -0.0, 1e-310, 3.0});
  record.set("number", 0.1);
  record.set("count", std::int64_t{-5});
  record.set("text", std::string("[0.1, 0] m³"));
  record.set("empty", std::string());
  return record;
}

class CheckpointFileTest : public testing::Test {
 protected:
  std::string path(const std::string& name = "checkpoint.h5") const {
    return folder_.path() + "/" + name;
  }
  static void flip(const std::string& path, std::uint64_t bit) {
    std::string bytes = test::read_file(path);
    char& byte = bytes[bit / 8 % bytes.size()];
    byte = static_cast<char>(byte ^ 1 << bit % 8);
    std::ofstream(path, std::ios::binary) << bytes;
  }
  test::TemporaryFolder folder_;
};

TEST_F(CheckpointFileTest, IsReadAsItWasWritten) {
  write_checkpoint(path(), sample(), 7);
  EXPECT_TRUE(read_checkpoint(path()) == sample());
  const Record some = read_checkpoint(path());
  EXPECT_THROW(some.integer("number"), std::invalid_argument);
  EXPECT_THROW(some.part("nothing"), std::invalid_argument);
  const std::string first = test::read_file(path());
  write_checkpoint(path(), sample(), 7);
  EXPECT_TRUE(first == test::read_file(path()));  // equal records are equal files
}

// In pieces of some megabytes: those of this box are four, and end within a layer.
TEST_F(CheckpointFileTest, HoldsNumbersOfCells) {
  const Decomposition box(Domain{30, 70, Side::Wall, Side::Wall, 50});
  std::vector<double> list(30 * 70 * 50 * 19);
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = std::sqrt(static_cast<double>(i));
  Record part, record;
  part.set("cells", box.values_of(list, 19));
  record.set("part", part);
  write_checkpoint(path(), record, 7);
  const Record read = read_checkpoint(path());
  const CellValues& values = read.part("part").cells("cells", box.domain().cells(), 19);
  EXPECT_TRUE(box.own_values(values) == list);
  EXPECT_TRUE(read == record);
  list[12345] = 0.0;  // the record refers to it
  EXPECT_FALSE(read == record);
  EXPECT_TRUE(read == read.kept());
  std::vector<double> line(5 * 19);  // some cells of a row
  values.read({{21, 33, 44}, {5, 1, 1}}, line);
  const std::size_t first = 19 * (30 * (70 * 44 + 33) + 21);
  for (std::size_t i = 0; i < line.size(); ++i) EXPECT_EQ(line[i], list[first + i]);
  EXPECT_THROW(read.part("part").cells("cells", {30, 50, 70}, 19), std::invalid_argument);
  EXPECT_THROW(read.part("part").cells("none", {30, 70, 50}, 19), std::invalid_argument);
}

TEST(Pieces, HoldEachCellOnceInItsOrder) {
  for (const CellRange& range : {CellRange{{3, 4, 5}, {30, 70, 50}},
                                 {{0, 0, 0}, {2000, 9, 1}},
                                 {{1, 0, 0}, {7, 1, 900}},
                                 {{0, 0, 0}, {100000, 3, 2}}}) {
    std::vector<Cell3> in_pieces, all;
    for (const CellRange& piece : pieces_of(range, 152)) {
      EXPECT_TRUE(range.holds(piece));
      EXPECT_TRUE(piece.count() * 152 <= std::size_t{4} << 20 ||
                  piece.size[1] * piece.size[2] == 1);
      piece.each([&](const Cell3& c, std::size_t) { in_pieces.push_back(c); });
    }
    range.each([&](const Cell3& c, std::size_t) { all.push_back(c); });
    EXPECT_TRUE(in_pieces == all);
  }
}

TEST_F(CheckpointFileTest, KeepsTheOneBefore) {
  for (const std::int64_t interval : {3, 6, 9}) {
    Record record;
    record.set("interval", interval);
    write_checkpoint(path(), record, interval, path("before.h5"));
  }
  EXPECT_EQ(read_checkpoint(path()).integer("interval"), 9);
  EXPECT_EQ(read_checkpoint(path("before.h5")).integer("interval"), 6);
}

TEST_F(CheckpointFileTest, EveryBitCounts) {
  write_checkpoint(path(), sample(), 7);
  const std::string whole = test::read_file(path());
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 500; ++trial) {
    // half of them in the last line
    const std::uint64_t bits = 8 * whole.size(), last = 8 * 92;
    flip(path(), trial % 2 ? random() % bits : bits - 1 - random() % last);
    EXPECT_THROW(read_checkpoint(path()), InputError) << trial;
    std::ofstream(path(), std::ios::binary) << whole;
  }
  for (std::size_t size = 0; size < whole.size(); size += 97) {
    std::ofstream(path(), std::ios::binary) << whole.substr(0, size);
    EXPECT_THROW(read_checkpoint(path()), InputError) << size;
  }
}

const std::string kScene = R"(
[box]
size = [1.0, 1.0]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-3
velocity_scale = 0.1
[particles]
diameter = 0.2
density = 2000.0
contact_stiffness = 1e4
[coupling]
[numerics]
cell = 0.02
[run]
end_time = 1.0
checkpoint_every = 0.1
)";

// 50 bits of either part: refused; with the pair before them that one is taken.
TEST_F(CheckpointFileTest, OfADamagedPairTheOneBeforeIsTaken) {
  const Scene scene = read_scene({folder_.write("scene.toml", kScene)});
  const Plan plan = make_plan(scene);
  protocol::SolidParts parts(folder_.path() + "/checkpoint");
  for (const std::int64_t interval : {10, 20}) {
    const std::string states(4000, static_cast<char>(interval));
    parts.keep(interval, std::as_bytes(std::span(states)));
    const Record record = checkpoint_record(scene, plan, interval, parts.name(interval));
    write_checkpoint(fluid_part(folder_.path(), "checkpoint"), record, interval,
                     fluid_part_before(folder_.path(), "checkpoint"));
  }
  const RestartOptions options{"checkpoint", {}};
  const auto found = find_restart(scene, folder_.path(), options);
  EXPECT_EQ(found->interval, 20);
  EXPECT_FALSE(found->earlier);
  EXPECT_NO_THROW(check_same_scene(*found, scene, plan, options));
  std::mt19937_64 random(2);
  for (const std::string& part : {path(), parts.name(20)})
    for (int trial = 0; trial < 50; ++trial) {
      const std::uint64_t bit = random() >> 8U;
      flip(part, bit);
      const auto other = find_restart(scene, folder_.path(), options);
      EXPECT_TRUE(other->earlier) << part << ' ' << bit;
      EXPECT_EQ(other->interval, 10);
      EXPECT_NE(other->remark.find(part), std::string::npos) << other->remark;
      flip(part, bit);
    }
  flip(path(), 4321);
  flip(parts.name(10), 4321);
  EXPECT_THROW(find_restart(scene, folder_.path(), options), InputError);
}

// At a fault each program keeps its own part, the fluid before it can know the solid's: that one
// must be there, but nothing says of which bits. A damaged part of the fluid is refused by the rank
// that looks; the others take what it has found.
TEST_F(CheckpointFileTest, AtAFaultEachKeepsItsOwn) {
  const Scene scene = read_scene({folder_.write("scene.toml", kScene)});
  const Plan plan = make_plan(scene);
  const RestartOptions fault{"fault", {}};
  const std::string fluid = path("fault.h5");
  protocol::SolidParts parts(folder_.path() + "/fault");
  const auto refusal = [&](const Scene& of) {
    try {
      find_restart(of, folder_.path(), fault);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  const auto expect_refused = [&](const std::string& words) {
    EXPECT_NE(refusal(scene).find(words), std::string::npos) << refusal(scene);
  };
  expect_refused("fault.h5: no checkpoint to restart from");
  write_checkpoint(fluid, checkpoint_record(scene, plan, 13, ""), 13);
  expect_refused("is missing: the solid's part of the checkpoint");
  expect_refused("use --restart alone for the last whole checkpoint");
  for (const char states : {'a', 'b'}) {  // whatever it holds
    const std::string part(4000, states);
    parts.keep(13, std::as_bytes(std::span(part)));
    const auto found = find_restart(scene, folder_.path(), fault);
    EXPECT_EQ(found->interval, 13);
    EXPECT_EQ(found->path, fluid);
    EXPECT_EQ(found->solid_part, parts.name(13));
    EXPECT_FALSE(found->earlier);
    EXPECT_NO_THROW(check_same_scene(*found, scene, plan, fault));
    const Restart taken = take_restart(scene, folder_.path(), fault, false);
    EXPECT_TRUE(taken.record == found->record);
    EXPECT_EQ(taken.solid_part, found->solid_part);
  }
  Scene alone = scene;
  alone.coupling.reset();
  EXPECT_NE(refusal(alone).find("is kept by coupled runs only"), std::string::npos)
      << refusal(alone);
  flip(fluid, 8 * fs::file_size(fluid) - 1);  // behind what is read without looking for damage
  expect_refused("fault.h5");
  EXPECT_EQ(take_restart(scene, folder_.path(), fault, false).interval, 13);
}

TEST_F(CheckpointFileTest, NamesEveryKeyOfAScene) {
  const Scene scene = read_scene({folder_.write("scene.toml", kScene)});
  EXPECT_EQ(scene.settings.at("fluid.density"), "1000");
  EXPECT_EQ(scene.settings.at("fluid.body_force"), "[0, 0]");  // a default
  EXPECT_EQ(scene.settings.at("particles.diameter"), "[0.2, 0.2]");
  for (const char* key : {"run.end_time", "output.fields_every", "coupling.timeout"})
    EXPECT_TRUE(may_change(key)) << key;
  for (const char* key :
       {"fluid.body_force", "boundary.2.velocity", "particles.variables.friction"})
    EXPECT_TRUE(may_be_accepted(key)) << key;
  for (const char* key : {"fluid.density", "boundary.2.side", "box.size", "numerics.cell"})
    EXPECT_FALSE(may_be_accepted(key) || may_change(key)) << key;
}

}  // namespace
