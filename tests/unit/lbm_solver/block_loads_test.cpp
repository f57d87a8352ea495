// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/block_loads.h"

#include <gtest/gtest.h>
#include <omp.h>

namespace {

using namespace lbm;

constexpr double kForce = 1e-6;

/// A fluid that a force drives along x past blocks, until nothing changes any more.
Fluid steady(const Domain& domain, VelocitySet lattice, const std::vector<CellBox>& blocks,
             int steps) {
  KernelChoice choice{.force = true,
                      .solid_term = SolidTerm::Resistance,
                      .parameters = {.tau = 0.8, .force_x = kForce}};
  choice.lattice = lattice;
  Fluid fluid(domain, choice);
  for (const CellBox& block : blocks) fluid.add_wall(block.from, block.to);
  fluid.advance(steps);
  return fluid;
}

struct Box {
  VelocitySet lattice;
  Domain domain;
  CellBox block;
  int cells;  // of the block
};
class EachBox : public testing::TestWithParam<Box> {};
INSTANTIATE_TEST_SUITE_P(Boxes, EachBox,
                         testing::Values(Box{VelocitySet::D2Q9,
                                             {24, 20, Side::Periodic, Side::Periodic},
                                             {{9, 7, 0}, {15, 12, 1}},
                                             30},
                                         Box{VelocitySet::D3Q19,
                                             {12, 10, Side::Periodic, Side::Periodic, 10,
                                              Side::Periodic},
                                             {{4, 3, 3}, {8, 7, 7}},
                                             64}),
                         [](const auto& info) { return name_of(info.param.lattice); });

// What drives the fluid outside of the block is all that it passes on: F = G × fluid cells. The
// tolerance is what is left of the start after the steps; round-off is below it.
TEST_P(EachBox, TakesWhatDrivesTheFluid) {
  const Box& box = GetParam();
  const Domain& d = box.domain;
  Fluid fluid = steady(d, box.lattice, {box.block}, 6000);
  const BodyLoad load = BlockLoads(fluid, {box.block}).loads()[0];
  const double drive = kForce * (d.nx * d.ny * d.nz - box.cells);
  EXPECT_NEAR(load.force.x(), drive, 1e-6 * drive);
  EXPECT_NEAR(load.force.y(), 0.0, 1e-6 * drive);
}

// Steps that share a parallel region: the same loads after each, and the same state.
TEST(BlockLoads, AreTheSameWithinARegion) {
  omp_set_num_threads(2);
  const Domain channel{30, 16, Side::Periodic, Side::Wall};
  const CellBox block{{10, 3, 0}, {18, 8, 1}};
  KernelChoice choice{.force = true,
                      .solid_term = SolidTerm::Resistance,
                      .parameters = {.tau = 0.8, .force_x = kForce}};
  Fluid one(channel, choice), together(channel, choice);
  for (Fluid* fluid : {&one, &together}) {
    fluid->add_wall(block.from, block.to);
    fluid->vary_body_force(InTime{5.0, 0.0});
  }
  const BlockLoads of_one(one, {block}), of_together(together, {block});
  std::vector<double> step_by_step, in_a_region;
  const auto keep = [](const BlockLoads& loads, std::vector<double>& all) {
    const BodyLoad load = loads.loads()[0];
    all.insert(all.end(), {load.force.x(), load.force.y(), load.torque.z()});
  };
  for (int step = 0; step < 23; ++step) {
    one.step();
    keep(of_one, step_by_step);
  }
  for (const int steps : {16, 7}) together.advance(steps, [&] { keep(of_together, in_a_region); });
  EXPECT_EQ(in_a_region, step_by_step);
  EXPECT_GT(std::abs(step_by_step.back()), 0.0);
  EXPECT_TRUE(one.save() == together.save());
  omp_set_num_threads(1);
}

// Bodies, whose loads are of two steps, beside a block.
TEST(BlockLoads, GoWithTheLoadsOfBodies) {
  const Domain channel{30, 16, Side::Periodic, Side::Wall};
  KernelChoice choice{.force = true,
                      .solid_term = SolidTerm::Resistance,
                      .parameters = {.tau = 0.8, .force_x = kForce}};
  Fluid one(channel, choice), together(channel, choice);
  const std::vector<Body> disc{{1, {22.3, 8.1, 0.0}, 3.1, {}, {}}};
  std::vector<double> step_by_step, in_one_call;
  const auto keep = [](const Fluid& fluid, std::vector<double>& all) {
    for (const BodyLoad& load : fluid.loads()) all.push_back(load.force.x());
  };
  for (Fluid* fluid : {&one, &together}) {
    fluid->add_wall({10, 3, 0}, {18, 8, 1});
    fluid->place(disc);
  }
  for (int step = 0; step < 9; ++step) {
    one.step();
    keep(one, step_by_step);
  }
  together.advance(9, [&] { keep(together, in_one_call); });
  EXPECT_EQ(in_one_call, step_by_step);
  EXPECT_EQ(step_by_step.size(), 9U);
}

// Two blocks that touch are one: forces add, and torques with the arms of their centres.
TEST(BlockLoads, AddUpWhereBlocksTouch) {
  const Domain channel{30, 16, Side::Periodic, Side::Wall};
  const CellBox whole{{10, 3, 0}, {18, 8, 1}}, low{{10, 3, 0}, {18, 5, 1}},
      high{{10, 5, 0}, {18, 8, 1}};
  Fluid fluid = steady(channel, VelocitySet::D2Q9, {whole}, 500);
  const BodyLoad one = BlockLoads(fluid, {whole}).loads()[0];
  const auto two = BlockLoads(fluid, {low, high}).loads();
  const auto about = [&](const BodyLoad& load, const CellBox& box) -> Vec3 {
    return load.torque + (box.centre() - whole.centre()).cross(load.force);
  };
  const Vec3 force = two[0].force + two[1].force;
  const Vec3 torque = about(two[0], low) + about(two[1], high);
  EXPECT_LT((force - one.force).norm(), 1e-14 * one.force.norm());
  EXPECT_LT((torque - one.torque).norm(), 1e-13 * one.torque.norm());
  EXPECT_GT(std::abs(one.torque.z()), 0.1 * one.force.norm());  // the flow is faster above
  // a cell that two blocks hold is of the first
  const auto overlapping = BlockLoads(fluid, {whole, low}).loads();
  EXPECT_EQ(overlapping[0].force, one.force);
  EXPECT_EQ(overlapping[1].force, Vec3(0.0, 0.0, 0.0));
  EXPECT_EQ(BlockLoads(fluid, {whole, low, low, high}).cells(), (std::vector<int>{40, 0, 0, 0}));
  EXPECT_EQ(BlockLoads(fluid, {low, low, whole}).cells(), (std::vector<int>{16, 0, 24}));
}

}  // namespace
