// SPDX-License-Identifier: MIT
#include "protocol/transport/trace.h"

#include <gtest/gtest.h>

#include <limits>

#include "protocol/transport/trace_compare.h"
#include "tests/support/job.h"
#include "tests/unit/protocol/samples.h"

namespace {

using namespace protocol;

/// Three intervals with two remote ranks, as a fluid rank would record them.
void record_sample(TraceWriter& w, double nudge = 0.0) {
  w.record(Direction::Sent, 0, encode(test::sample_hello(Role::Fluid)));
  w.record(Direction::Received, 0, encode(test::sample_hello(Role::Solid)));
  for (std::int64_t k = 0; k < 3; ++k)
    for (int r = 0; r < 2; ++r) {
      auto states = test::sample_states(k, 4, 10 - 5 * r);
      if (k > 0) states.shapes.clear();
      if (k == 2) states.head.flags = kLast;
      w.record(Direction::Received, r, encode(states));
      if (k == 2) continue;
      auto loads = test::sample_loads(k, 4, 10 - 5 * r);
      if (k == 1 && r == 1) loads.loads[2].force[1] += nudge;
      w.record(Direction::Sent, r, encode(loads));
    }
}

class TraceTest : public testing::Test {
 protected:
  std::string file(const char* name) const { return folder_.path() + "/" + name; }
  void make(const char* name, double nudge = 0.0) const {
    TraceWriter writer(file(name), "fluid", 0, 2);
    record_sample(writer, nudge);
  }
  test::TemporaryFolder folder_;
};

TEST_F(TraceTest, GivesBackEveryFrameToTheBit) {
  make("a.h5");
  const Trace trace(file("a.h5"));
  EXPECT_EQ(trace.recorder(), "fluid");
  EXPECT_EQ(trace.remote_size(), 2);
  ASSERT_EQ(trace.frames().size(), 2U + 3 * 2 + 2 * 2);
  EXPECT_EQ(trace.frame(trace.frames()[0]), encode(test::sample_hello(Role::Fluid)));
  EXPECT_EQ(trace.frame(trace.frames()[2]), encode(test::sample_states(0, 4, 10)));
  EXPECT_EQ(trace.frame(trace.frames()[3]), encode(test::sample_loads(0, 4, 10)));
  EXPECT_EQ(trace.hello(Role::Solid).program, "liggghts");
}

TEST_F(TraceTest, TimelineMergesRanksAndRemembersShapes) {
  make("a.h5");
  const auto record = timeline(Trace(file("a.h5")));
  ASSERT_EQ(record.size(), 3U);
  ASSERT_EQ(record[1].states.size(), 8U);
  EXPECT_EQ(record[1].states.front().id, 5);
  EXPECT_EQ(record[1].shapes.front().id, 5);
  EXPECT_EQ(record[1].shapes.front().radius, 0.00125);
  EXPECT_TRUE(record[2].loads.empty());
  EXPECT_EQ(record[2].head.flags, static_cast<std::uint32_t>(kLast));
}

TEST_F(TraceTest, IsReadableWhileItIsWritten) {
  TraceWriter writer(file("open.h5"), "fluid", 0, 2);
  record_sample(writer);
  writer.flush();
  EXPECT_EQ(timeline(Trace(file("open.h5"))).size(), 3U);
}

TEST_F(TraceTest, ComparisonNamesTheFirstDifference) {
  make("a.h5");
  make("b.h5", 1e-9);
  const auto a = timeline(Trace(file("a.h5"))), b = timeline(Trace(file("b.h5")));
  TraceComparison same(a), other(a);
  for (std::size_t k = 0; k < a.size(); ++k) {
    same.loads(a[k].head.interval, a[k].loads, a[k].loads);
    other.loads(a[k].head.interval, a[k].loads, b[k].loads);
  }
  EXPECT_FALSE(same.first());
  EXPECT_EQ(same.largest(), 0.0);
  ASSERT_TRUE(other.first());
  EXPECT_EQ(other.first()->interval, 1);
  EXPECT_EQ(other.first()->id, 7);
  EXPECT_EQ(other.first()->field, "force[1]");
  EXPECT_NEAR(other.largest(), 1e-9, 2e-9);  // relative to a force of order one
  EXPECT_GT(other.largest(), 0.0);
}

TEST_F(TraceTest, PhysicsMeasuresPlacesInRadiiAndLoadsInWeights) {
  IntervalRecord record;
  record.states = {{1, {0.2, 0.999, 0.0}, {3.0, 0.0, 0.0}, {}}};
  record.shapes = {{1, 0.01, 2.0, 1e-4, 1}};
  record.loads = {{1, {5.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}};
  Hello fluid;
  fluid.box_hi = {1.0, 1.0, 1.0};
  fluid.periodic = {0, 1, 0};
  fluid.gravity = {0.0, -10.0, 0.0};
  auto other = record;
  other.states[0].x = {0.2002, -0.001, 0.0};  // a fiftieth of a radius; y is its periodic image
  other.loads[0].force[0] = 5.2;              // a hundredth of the weight
  TraceComparison compare(physical_scales(std::vector{record}, fluid));
  compare.states(0, record.states, other.states);
  EXPECT_NEAR(compare.largest(), 0.02, 1e-12);
  compare.loads(0, record.loads, other.loads);
  EXPECT_NEAR(compare.largest(), 0.02, 1e-12);
  other.loads[0].force[0] = 6.0;
  compare.loads(0, record.loads, other.loads);
  EXPECT_NEAR(compare.largest(), 0.05, 1e-12);
  EXPECT_NE(compare.text().find("0.02 radii in place"), std::string::npos) << compare.text();
  EXPECT_NE(compare.text().find("0.05 weights in force"), std::string::npos) << compare.text();
}

TEST_F(TraceTest, ATolerancePassesOverRoundOff) {
  IntervalRecord record;
  record.states = {{1, {0.2, 0.0, 0.0}, {}, {}}};
  record.shapes = {{1, 0.01, 2.0, 1e-4, 1}};
  TraceComparison compare(physical_scales(std::vector{record}, Hello()), 0.1);
  for (const auto& [interval, way] : {std::pair{1, 1e-15}, {5, 0.002}, {6, 0.009}, {7, 0.004}}) {
    auto other = record.states;
    other[0].x[0] += way;
    compare.states(interval, record.states, other);
  }
  ASSERT_TRUE(compare.first() && compare.first_beyond() && compare.worst());
  EXPECT_EQ(compare.first()->interval, 1);
  EXPECT_EQ(compare.first_beyond()->interval, 5);  // a fifth of a radius
  EXPECT_EQ(compare.worst()->interval, 6);
  EXPECT_NE(compare.text().find("first beyond the tolerance at interval 5"), std::string::npos);
}

TEST_F(TraceTest, AMissingParticleIsAnInfiniteDifference) {
  make("a.h5");
  auto a = timeline(Trace(file("a.h5")));
  TraceComparison c(a);
  auto fewer = a[0].loads;
  fewer.erase(fewer.begin() + 2);
  c.loads(0, a[0].loads, fewer);
  EXPECT_EQ(c.largest(), std::numeric_limits<double>::infinity());
  EXPECT_EQ(c.first()->id, 7);
}

TEST_F(TraceTest, SaysWhatIsWrongWithAFile) {
  const auto complaint = [&](const std::string& path) -> std::string {
    try {
      const Trace trace(path);
    } catch (const std::exception& e) {
      return e.what();
    }
    return "no complaint";
  };
  EXPECT_NE(complaint(file("none.h5")).find("no such file"), std::string::npos);
  folder_.write("text.h5", "this is no HDF5 file");
  EXPECT_NE(complaint(file("text.h5")).find("text.h5"), std::string::npos);
  { const auto other = hdf5::open_file(file("other.h5"), hdf5::Open::Create); }
  EXPECT_NE(complaint(file("other.h5")).find("no trace"), std::string::npos);
  make("long.h5");
  {  // what is not stored counts as zeros: the file stays small, and would not fit into any memory
    const auto damaged = hdf5::open_file(file("long.h5"), hdf5::Open::Append);
    const hdf5::Handle table(H5Dopen2(damaged, "bytes", H5P_DEFAULT), H5Dclose, "open");
    const hsize_t size = 1'000'000'000'000'000;
    hdf5::check(H5Dset_extent(table, &size), "grow");
  }
  EXPECT_NE(complaint(file("long.h5")).find("is damaged: bytes claims 1000000000000000 rows"),
            std::string::npos)
      << complaint(file("long.h5"));
}

}  // namespace
