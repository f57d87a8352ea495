// SPDX-License-Identifier: GPL-2.0-or-later
/// Files of a box that several ranks share, against those of one rank.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "lbm_solver/coupling/shown_cells.h"
#include "lbm_solver/io/checkpoint.h"
#include "lbm_solver/io/field_writer.h"
#include "tests/ranks/on_ranks.h"

namespace {

using namespace test;

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
  const KernelChoice choice = choice_for(VelocitySet::D3Q19, Precision::Double);
  const auto make = [&](const Decomposition& ranks) {
    Fluid fluid(ranks, choice);
    add_patches(fluid);
    add_movers(fluid);
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
        Fluid fluid(d, choice_for(VelocitySet::D3Q19, precision));
        fluid.add_wall({3, 0, 0}, {9, 4, domain.nz});
        randomise(fluid);
        fluid.place(bodies_in(domain));
        fluid.advance(3);
        Record record;
        record.set("populations", fluid.save().cells().at("populations"));
        write_checkpoint(folder / (name + ".h5"), record, 3, {}, &d);
        const CellFields cells = shown_cells(fluid, plan, false);
        const Vec3 flux = mean_arrived_momentum(fluid);
        if (d.rank() != 0) return send_fields(cells, d);
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

}  // namespace
