// SPDX-License-Identifier: GPL-2.0-or-later
/// `lbm --keys`: every key that the reader knows is there, with what the reader knows of it.
#include "lbm_solver/io/scene_keys.h"

#include <gtest/gtest.h>

#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/io/table_reader.h"

namespace {

using namespace lbm;

TEST(SceneKeys, EachHasASentenceAndEachSentenceAKey) {
  for (const std::string& complaint : complaints_about_keys()) ADD_FAILURE() << complaint;
}

TEST(SceneKeys, SayWhatTheReaderDoes) {
  const std::string keys = describe_keys();
  for (const char* row :
       {"| `fluid.density` | number | kg/m³ | required | > 0 |",
        "| `box.sides_z` | choice |  | \"wall\" | wall, periodic |",
        "| `numerics.lattice` | choice |  | \"auto\" | auto, D2Q9, D3Q19, D3Q27 |",
        "| `obstacle.spin` | number or vector | rad/s | 0 |",
        "| `coupling.substeps` | integer |  | by rule (collision.md) | ≥ 1 |",
        "| `coupling.inner_inertia` | true or false |  | true |",
        "| `particles.diameter` | number or [smallest, largest] | m | required | > 0 |",
        "| `particles.start` | list of vectors | m | none |",
        "| `boundary.from` | number or vector | m | whole side | the side |"})
    EXPECT_NE(keys.find(row), std::string::npos) << row;
}

TEST(SceneKeys, AreNotedOnceAndGatherTheirAlternatives) {
  KeyNotes notes;
  notes.add({"a.b", "choice", "", "\"x\"", "x|y"});
  notes.add({"a.b", "choice", "", "\"x\"", "x|z"});
  notes.add({"a.c", "number", "m", "1", "> 0"});
  notes.add({"a.c", "vector", "m", "1", ""});
  ASSERT_EQ(notes.all().size(), 2u);
  EXPECT_EQ(notes.all()[0].range, "x|y|z");
  EXPECT_EQ(notes.all()[1].type, "number|vector");
  EXPECT_EQ(notes.all()[1].range, "> 0");
}

}  // namespace
