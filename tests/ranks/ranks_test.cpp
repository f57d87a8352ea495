// SPDX-License-Identifier: GPL-2.0-or-later
/// A box shared by several ranks against the same box on one: started as `mpirun -np N ranks`,
/// where every rank also sweeps the whole box by itself and compares its own cells: bit for bit
/// where rows are whole. Where x is cut, a covered cell shares its SIMD block with other cells,
/// which a float box sweeps in double precision with it: then to round-off of what is stored.
#include <gtest/gtest.h>

#include <mpi.h>
#include <omp.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numeric>
#include <random>

#include "lbm_solver/coupling/lubrication.h"
#include "lbm_solver/coupling/shown_cells.h"
#include "lbm_solver/io/checkpoint.h"
#include "lbm_solver/io/field_writer.h"
#include "lbm_solver/solver/fluid.h"
#include "lbm_solver/solver/work.h"
#include "tests/support/moving_obstacles.h"

namespace {

using namespace lbm;

int world_size() {
  int size = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

/// A population of the random state, the same on whatever rank asks.
double noise(const Domain& d, int q, int x, int y, int z) {
  std::minstd_rand random(static_cast<unsigned>(((z * d.ny + y) * d.nx + x) * 27 + q + 1));
  random.discard(3);
  return 1e-3 * (2.0 * random() / std::minstd_rand::max() - 1.0);
}

void randomise(Fluid& fluid) {
  const Cell3 &n = fluid.cells().size, &b = fluid.cells().begin;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x)
        for (int q = 0; q < fluid.lattice().Q; ++q)
          fluid.arriving(q, x, y, z) = noise(fluid.domain(), q, x + b[0], y + b[1], z + b[2]);
}

/// Sides with an inlet, an outlet and a lid where there are walls for them.
void add_patches(Fluid& fluid) {
  const Domain& d = fluid.domain();
  if (d.x == Side::Wall) {
    Opening in = Opening::whole(d, SideName::Left), out = Opening::whole(d, SideName::Right);
    if (!in.closed[0]) in.begin[0] = 2;  // begins within a rank, ends in another
    fluid.add(std::make_unique<VelocityPatch>(fluid.lattice(), fluid.links(in), Vec3(0.02, 0.0),
                                              true, in, InTime{}));
    fluid.add(std::make_unique<OutflowPatch>(fluid.links(out), out.side, 0.001, 0.01));
  }
  if (d.y == Side::Wall) {
    const Opening top = Opening::whole(d, SideName::Top);
    fluid.add(std::make_unique<PressurePatch>(fluid.links(top), top.side, 0.002, InTime{}));
  }
}

/// One wider than a subdomain over the middle of the box, one over its corner, one in contact with
/// the first.
std::vector<Body> bodies_in(const Domain& d) {
  const bool flat = d.dimension() == 2;
  const Vec3 middle(0.5 * d.nx + 0.3, 0.5 * d.ny - 0.2, flat ? 0.0 : 0.5 * d.nz + 0.4);
  std::vector<Body> bodies{{1, middle, 5.1, {0.01, -0.02, 0.01}, {0.001, 0.002, -0.003}},
                           {2, {0.3, 0.6, 0.2}, 3.2, {-0.01, 0.01, 0.02}, {0.002, 0.0, 0.001}},
                           {3, middle + Vec3(7.9, 0.4, 0.0), 2.7, {0.0, 0.01, 0.0}, Spin()}};
  for (Body& b : bodies)
    if (flat) {
      b.centre.z() = b.velocity.z() = 0.0;
      b.spin = b.spin.z();
    }
  return bodies;
}

/// Round-off of populations (deviations up to 0.05) and of a body's load.
struct Limits {
  double population, load;
};
Limits limits(Precision precision, const Cell3& grid) {
  const bool whole_rows = grid[0] == 1;
  if (precision == Precision::Double) return {whole_rows ? 0.0 : 1e-16, 1e-13};
  return {whole_rows ? 0.0 : 2e-8, whole_rows ? 1e-13 : 2e-7};
}

void expect_same_cells(const Fluid& part, const Fluid& whole, double limit) {
  const Cell3 &n = part.cells().size, &b = part.cells().begin;
  double largest = 0.0;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x)
        for (int q = 0; q < part.lattice().Q; ++q) {
          const double here = part.arriving(q, x, y, z);
          const double there = whole.arriving(q, x + b[0], y + b[1], z + b[2]);
          if (std::abs(here - there) > limit && largest == 0.0)
            ADD_FAILURE() << "rank " << part.ranks().rank() << ": f_" << q << " at " << x + b[0]
                          << ' ' << y + b[1] << ' ' << z + b[2] << " is " << here << ", alone "
                          << there;
          largest = std::max(largest, std::abs(here - there));
        }
  EXPECT_LE(largest, limit);
}

struct Box {
  std::string lattice;
  Domain domain;
};

std::vector<Box> boxes() {
  std::vector<Box> all;
  const Side sides[] = {Side::Periodic, Side::Wall};
  for (const Side x : sides)
    for (const Side y : sides) {
      all.push_back({"D2Q9", {29, 23, x, y}});
      for (const Side z : sides)
        for (const char* lattice : {"D3Q19", "D3Q27"})
          all.push_back({lattice, {23, 14, x, y, 13, z}});
    }
  return all;
}

/// Every grid of as many ranks as there are that leaves each two cells along an axis.
std::vector<Cell3> grids(const Domain& d) {
  std::vector<Cell3> all;
  const int n = world_size();
  for (int x = 1; x <= n; ++x)
    for (int y = 1; x * y <= n; ++y)
      if (n % (x * y) == 0 && d.nx >= 2 * x && d.ny >= 2 * y &&
          (x * y == n || d.nz >= 2 * n / (x * y)))
        all.push_back({x, y, n / (x * y)});
  return all;
}

/// Equal blocks and, beside them, blocks of quite different sizes.
std::vector<Cuts> cuts_of(const Domain& d, const Cell3& grid) {
  Cuts uneven = equal_cuts(d, grid);
  for (int a = 0; a < 3; ++a)
    for (int p = 1; p < grid[a]; ++p)  // every block but the last is as thin as may be
      uneven[a][p] = 2 * p;
  return {equal_cuts(d, grid), uneven};
}

KernelChoice choice_for(const std::string& lattice, Precision precision) {
  return {.collision = CollisionOperator::Trt,
          .solid_term = "layered_resistance",
          .parameters = {.tau = 0.7},
          .lattice = lattice,
          .precision = precision};
}

std::vector<double> numbers(const std::vector<BodyLoad>& loads) {
  std::vector<double> all;
  for (const BodyLoad& l : loads)
    for (const Vec3* v : {&l.force, &l.torque}) all.insert(all.end(), v->begin(), v->end());
  return all;
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double limit) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], limit) << i;
}

TEST(Ranks, SweepTheSameCellsAsOneAlone) {
  for (const Box& box : boxes())
    for (const Cell3& grid : grids(box.domain))
      for (const int way : {0, 1, 2}) {  // double, single, double with uneven blocks
        const Precision precision = way == 1 ? Precision::Single : Precision::Double;
        const Decomposition ranks(box.domain, MPI_COMM_WORLD, grid,
                                  cuts_of(box.domain, grid)[way == 2]);
        SCOPED_TRACE(testing::Message()
                     << box.lattice << ' ' << grid[0] << grid[1] << grid[2] << ", " << way);
        const KernelChoice choice = choice_for(box.lattice, precision);
        const Limits limit = limits(precision, grid);
        Fluid part(ranks, choice), whole(box.domain, choice);
        for (Fluid* f : {&part, &whole}) {
          add_patches(*f);
          f->add_wall({3, 0, 0}, {9, 4, box.domain.nz});
          randomise(*f);
        }
        std::vector<Body> bodies = bodies_in(box.domain);
        for (int step = 0; step < 5; ++step) {
          part.place(bodies);
          whole.place(bodies);
          part.step();
          whole.step();
          std::vector<double> sums = numbers(part.loads());
          ranks.sum(sums);
          expect_near(sums, numbers(whole.loads()), limit.load);
          for (Body& b : bodies) b.centre += b.velocity;
        }
        expect_same_cells(part, whole, limit.population);
        const auto a = part.extremes(), b = whole.extremes();
        const double of_sums = 1e-12 + 1e4 * limit.population;
        EXPECT_NEAR(a.max_speed, b.max_speed, 30.0 * limit.population);
        EXPECT_EQ(a.cell, b.cell);
        EXPECT_NEAR(a.mass_excess, b.mass_excess, of_sums);
        EXPECT_NEAR(part.mass_in(), whole.mass_in(), of_sums);
        const Vec3 place(0.5 * box.domain.nx, 0.5 * box.domain.ny, 0.5 * box.domain.nz);
        EXPECT_NEAR(part.at(place).u.x(), whole.at(place).u.x(), 1e-15 + 30.0 * limit.population);
      }
}

/// What walls that move do does not depend on the ranks: cells, and loads to 1e-12 of the largest.
TEST(Ranks, MoveTheSameWallsAsOneAlone) {
  const Side p = Side::Periodic, w = Side::Wall;
  for (const Box& box : {Box{"D2Q9", {29, 23, p, w}}, Box{"D3Q19", {23, 14, p, w, 13, p}}})
    for (const Cell3& grid : grids(box.domain)) {
      SCOPED_TRACE(testing::Message() << box.lattice << ' ' << grid[0] << grid[1] << grid[2]);
      const Decomposition ranks(box.domain, MPI_COMM_WORLD, grid);
      const KernelChoice choice = choice_for(box.lattice, Precision::Double);
      Fluid part(ranks, choice), whole(box.domain, choice);
      std::vector<Body> bodies = bodies_in(box.domain);
      for (Fluid* f : {&part, &whole}) {
        test::add_movers(*f);
        f->place(bodies);
        randomise(*f);
      }
      double largest = 0.0;
      std::vector<double> sums, alone;
      for (int step = 0; step < 15; ++step) {
        part.step();
        whole.step();
        sums = numbers(part.fixed_loads());
        alone = numbers(whole.fixed_loads());
        ranks.sum(sums);
        for (const double load : alone) largest = std::max(largest, std::abs(load));
        expect_near(sums, alone, 1e-12 * largest);
      }
      EXPECT_GT(largest, 1e-3);
      expect_same_cells(part, whole, grid[0] == 1 ? 0.0 : 1e-15);
    }
}

/// A name for a file or folder, the same on all ranks; removed by the first one.
class SharedPath {
 public:
  SharedPath() {
    int id = static_cast<int>(getpid());
    MPI_Bcast(&id, 1, MPI_INT, 0, MPI_COMM_WORLD);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    path_ = std::filesystem::temp_directory_path() / ("bplbm_ranks_" + std::to_string(id));
    if (rank_ == 0) std::filesystem::create_directories(path_);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  ~SharedPath() {
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank_ == 0) std::filesystem::remove_all(path_);
  }
  SharedPath(const SharedPath&) = delete;
  SharedPath& operator=(const SharedPath&) = delete;
  std::string operator/(const std::string& name) const { return path_ / name; }

 private:
  int rank_ = 0;
  std::filesystem::path path_;
};

TEST(Ranks, GoOnFromAStateOfAnotherGrid) {
  const Domain domain{23, 14, Side::Wall, Side::Periodic, 13, Side::Wall};
  const KernelChoice choice = choice_for("D3Q19", Precision::Double);
  const auto make = [&](const Decomposition& ranks) {
    Fluid fluid(ranks, choice);
    add_patches(fluid);
    test::add_movers(fluid);
    fluid.place(bodies_in(domain));
    return fluid;
  };
  const auto all = grids(domain);
  const Decomposition first(domain, MPI_COMM_WORLD, all.front());
  const Decomposition second(domain, MPI_COMM_WORLD, all.back());
  Fluid one = make(first), two = make(second), whole = make(Decomposition(domain));
  randomise(one);
  randomise(whole);
  one.advance(7);  // an odd number: the state does not depend on the slots' parity
  whole.advance(7);
  const SharedPath folder;
  const Record state = one.save();
  write_checkpoint(folder / "state.h5", state, 7, {}, &first);
  MPI_Barrier(MPI_COMM_WORLD);
  two.load(read_checkpoint(folder / "state.h5"));
  for (int step = 0; step < 4; ++step) {  // the first load needs that of the step before
    two.step();
    whole.step();
    std::vector<double> sums = numbers(two.fixed_loads());
    second.sum(sums);
    expect_near(sums, numbers(whole.fixed_loads()), 1e-13);
  }
  expect_same_cells(two, whole, 1e-16);
  EXPECT_NEAR(two.mass_in(), whole.mass_in(), 1e-13);
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Every bit of the files, where rows are whole: a box of several pieces a rank, single and double.
TEST(Ranks, WriteTheFilesOfOneAlone) {
  const Domain domain{64, 48, Side::Wall, Side::Periodic, 40, Side::Wall};
  const SharedPath folder;
  Plan plan;
  plan.units = {0.01, 0.1, 1000.0, 1.0, {0.0, 0.0, 0.0}};
  for (const Precision precision : {Precision::Double, Precision::Single})
    for (const Cell3& grid : grids(domain)) {
      if (grid[0] > 1) continue;
      const Decomposition ranks(domain, MPI_COMM_WORLD, grid), alone(domain);
      const auto write = [&](const Decomposition& d, const std::string& name) {
        Fluid fluid(d, choice_for("D3Q19", precision));
        fluid.add_wall({3, 0, 0}, {9, 4, domain.nz});
        randomise(fluid);
        fluid.place(bodies_in(domain));
        fluid.advance(3);
        Record record;
        record.set("populations", fluid.save().cells().at("populations"));
        write_checkpoint(folder / (name + ".h5"), record, 3, {}, &d);
        const CellFields cells = shown_cells(fluid, plan, false);
        const Vec3 flux = mean_arrived_momentum(fluid);
        if (d.rank() != 0) return write_fields(-1, cells, 3, d);
        std::filesystem::create_directories(folder / name);
        FieldWriter fields(folder / name, plan.units, 3);
        FieldFrame frame;
        frame.cells = cells;
        frame.flux = flux;
        fields.write(frame, d);
      };
      write(ranks, "many");
      if (ranks.rank() != 0) continue;
      write(alone, "one");
      for (const char* name : {"one.h5", "one/fields.h5", "one/fields.xdmf"}) {
        const std::string one = bytes_of(folder / name);
        const std::string many = bytes_of(folder / ("many" + std::string(name).substr(3)));
        EXPECT_FALSE(one.empty()) << name;
        EXPECT_TRUE(one == many) << name << " of " << grid[0] << grid[1] << grid[2];
      }
    }
}

// The mean velocity is added up in whole numbers, so that every grid finds the same force.
TEST(Ranks, HoldTheSameFlow) {
  const Domain domain{23, 14, Side::Wall, Side::Periodic, 13, Side::Wall};
  KernelChoice choice = choice_for("D3Q19", Precision::Double);
  choice.force = true;
  for (const Cell3& grid : grids(domain)) {
    const Decomposition ranks(domain, MPI_COMM_WORLD, grid);
    Fluid part(ranks, choice), whole(domain, choice);
    for (Fluid* f : {&part, &whole}) {
      f->place(bodies_in(domain));
      f->hold_flow({1, 0.01, {}, domain.ny});
      randomise(*f);
      f->advance(40);
    }
    EXPECT_NEAR(part.flow_control()->force(), whole.flow_control()->force(), 1e-15);
    expect_same_cells(part, whole, 1e-15);
  }
}

// The eddy viscosity looks one cell beyond each face, and is found from the same velocities on
// every grid; the pressure on an opening from the mass through it, added up in another order.
TEST(Ranks, HaveTheSameEddiesAndTheSameHeldPressure) {
  const Domain domain{23, 14, Side::Wall, Side::Periodic, 13, Side::Wall};
  KernelChoice choice = choice_for("D3Q19", Precision::Double);
  choice.collision = CollisionOperator::CentralMoment;
  choice.solid_term = "layered_noble_torczynski";
  choice.parameters.smagorinsky = 0.2;
  choice.eddies = EddyModel::Wale;
  for (const Cell3& grid : grids(domain)) {
    const Decomposition ranks(domain, MPI_COMM_WORLD, grid);
    Fluid part(ranks, choice), whole(domain, choice);
    for (Fluid* f : {&part, &whole}) {
      f->place(bodies_in(domain));
      for (const SideName side : {SideName::Left, SideName::Right})
        f->add(std::make_unique<PressurePatch>(f->links(Opening::whole(domain, side)), side, 0.0,
                                               InTime{}));
      f->hold_flow(PressureControl(0, 0.01 * 14 * 13, {}, 14 * 13, 23, 0.0));
      randomise(*f);
      f->advance(21);
    }
    EXPECT_NEAR(part.pressure_control()->drho(), whole.pressure_control()->drho(), 1e-13);
    expect_same_cells(part, whole, 1e-12);
  }
}

TEST(Ranks, AddEachLubricationForceOnce) {
  for (const Side side : {Side::Periodic, Side::Wall}) {
    const Domain domain{24, 20, side, side, 16, side};
    std::vector<Body> bodies;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> at(0.0, 1.0), speed(-0.01, 0.01);
    for (int i = 0; i < 60; ++i)
      bodies.push_back({i,
                        {24.0 * at(random), 20.0 * at(random), 16.0 * at(random)},
                        1.5,
                        {speed(random), speed(random), speed(random)}});
    const std::vector<double> masses(bodies.size(), 20.0);
    const Lubrication lubrication{0.1, 1.0, 1.0};
    std::vector<BodyLoad> whole(bodies.size());
    lubrication.add(bodies, masses, domain, whole);
    for (const Cell3& grid : grids(domain)) {
      const Decomposition ranks(domain, MPI_COMM_WORLD, grid);
      std::vector<BodyLoad> part(bodies.size());
      lubrication.add(bodies, masses, domain, ranks.cells(), part);
      std::vector<double> sums = numbers(part);
      ranks.sum(sums);
      expect_near(sums, numbers(whole), 1e-14);
    }
  }
}

// A packing in the lower half of a box: the cuts move there, and all ranks agree on them.
TEST(Ranks, ShareTheWorkOfAPacking) {
  const Domain domain{48, 40, Side::Periodic, Side::Periodic, 96, Side::Wall};
  const KernelChoice choice = choice_for("D3Q19", Precision::Double);
  std::vector<Body> bodies;
  for (int i = 0; i < 4 * 3 * 4; ++i)
    bodies.push_back({i + 1,
                      {6.0 + 12.0 * (i % 4), 7.0 + 13.0 * (i / 4 % 3), 6.0 + 12.0 * (i / 12)},
                      5.5,
                      {0.01, 0.0, 0.0},
                      Spin()});
  Fluid whole(domain, choice);
  whole.place(bodies);
  const LayerWork work = work_of(whole);
  for (const auto& axis : work)
    EXPECT_NEAR(std::accumulate(axis.begin(), axis.end(), 0.0),
                std::accumulate(work[2].begin(), work[2].end(), 0.0), 1e-6);
  EXPECT_EQ(work[2][90], 48.0 * 40.0);  // fluid alone
  EXPECT_GT(work[2][40], 1.3 * 48.0 * 40.0);
  for (const Cell3& grid : grids(domain)) {
    const Decomposition ranks(domain, MPI_COMM_WORLD, grid);
    Fluid part(ranks, choice);
    part.place(bodies);
    const LayerWork found = work_of(part);
    for (int a = 0; a < 3 && grid[0] == 1; ++a) EXPECT_EQ(found[a], work[a]);
    const Decomposition balanced = of_equal_work(ranks, found);
    EXPECT_EQ(balanced.grid(), grid);
    EXPECT_LE(imbalance(balanced, found), imbalance(ranks, found) + 1e-12);
    if (grid[2] == world_size()) {  // as near as whole layers come
      EXPECT_GT(imbalance(ranks, found), 1.15);
      EXPECT_LT(imbalance(balanced, found), 1.1);
      EXPECT_LT(balanced.cuts()[2][1], ranks.cuts()[2][1]);
    }
    const LayerWork kept = load_work(save(found), domain);
    EXPECT_EQ(kept, found);
    EXPECT_THROW(load_work(save(found), {48, 40, Side::Wall, Side::Wall, 95}),
                 std::invalid_argument);
  }
}

TEST(Ranks, CutLayersIntoEqualSums) {
  using Cut = std::vector<int>;
  const std::vector<double> even(10, 1.0), half{3, 3, 3, 3, 3, 1, 1, 1, 1, 1},
      peak{0, 0, 0, 0, 90, 0, 0, 0, 0, 0};
  EXPECT_EQ(cuts_of_equal_sums(even, 1), (Cut{0, 10}));
  EXPECT_EQ(cuts_of_equal_sums(even, 2), (Cut{0, 5, 10}));
  EXPECT_EQ(cuts_of_equal_sums(half, 2), (Cut{0, 3, 10}));        // 9 and 11 of 20
  EXPECT_EQ(cuts_of_equal_sums(half, 4), (Cut{0, 2, 4, 6, 10}));  // no block thinner than 2 cells
  EXPECT_EQ(cuts_of_equal_sums(peak, 5), (Cut{0, 2, 4, 6, 8, 10}));
  const Domain box{8, 8, Side::Wall, Side::Wall, 10};
  Cuts cuts = equal_cuts(box, {1, 1, world_size()});
  cuts[2][1] = 1;
  EXPECT_THROW(Decomposition(box, MPI_COMM_WORLD, {1, 1, world_size()}, cuts),
               std::invalid_argument);
}

TEST(Ranks, CutZFirstAndNeverTooThin) {
  EXPECT_EQ(choose_grid({40, 40, Side::Wall, Side::Wall, 40}, 2), (Cell3{1, 1, 2}));
  EXPECT_EQ(choose_grid({40, 40, Side::Wall, Side::Wall, 40}, 4), (Cell3{1, 1, 4}));
  EXPECT_EQ(choose_grid({40, 40, Side::Wall, Side::Wall, 40}, 8), (Cell3{1, 2, 4}));
  EXPECT_EQ(choose_grid({40, 40, Side::Wall, Side::Wall}, 3), (Cell3{1, 3, 1}));
  EXPECT_EQ(choose_grid({4000, 40, Side::Wall, Side::Wall}, 4), (Cell3{4, 1, 1}));
  EXPECT_THROW(choose_grid({4, 4, Side::Wall, Side::Wall}, 7), std::invalid_argument);
}

}  // namespace

int main(int argc, char** argv) {
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  testing::InitGoogleTest(&argc, argv);
  omp_set_num_threads(world_size() <= 2 ? 2 : 1);
  int failed = RUN_ALL_TESTS();
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Finalize();
  return failed;
}
