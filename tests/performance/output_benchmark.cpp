// SPDX-License-Identifier: GPL-2.0-or-later
/// How a box on several ranks gets into one file: gathered on rank 0, as lbm does, or written by
/// all with parallel HDF5. Built by hand where that is installed: `ninja output_benchmark`.
///   mpirun -np 2 output_benchmark FOLDER
#include <fcntl.h>
#include <hdf5.h>
#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "tests/performance/usage.h"

namespace {

struct Ranks {
  int rank = 0, size = 1;
};

void on_disk(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY);
  ::fsync(file);
  ::close(file);
}

/// Seconds that `write` takes, from all ranks ready to all ranks done.
double seconds(const std::function<void()>& write) {
  MPI_Barrier(MPI_COMM_WORLD);
  const double begin = MPI_Wtime();
  write();
  MPI_Barrier(MPI_COMM_WORLD);
  return MPI_Wtime() - begin;
}

void gathered(const std::string& path, const std::vector<double>& mine, const Ranks& ranks) {
  const int count = static_cast<int>(mine.size());
  std::vector<double> all(ranks.rank == 0 ? mine.size() * ranks.size : 0);
  MPI_Gather(mine.data(), count, MPI_DOUBLE, all.data(), count, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  if (ranks.rank != 0) return;
  const hsize_t total = all.size();
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(1, &total, nullptr);
  const hid_t set =
      H5Dcreate2(file, "x", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data());
  H5Dclose(set);
  H5Sclose(space);
  H5Fclose(file);
  on_disk(path);
}

void parallel(const std::string& path, const std::vector<double>& mine, const Ranks& ranks) {
  const hsize_t count = mine.size(), total = count * ranks.size, start = count * ranks.rank;
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS), transfer = H5Pcreate(H5P_DATASET_XFER);
  H5Pset_fapl_mpio(access, MPI_COMM_WORLD, MPI_INFO_NULL);
  H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  const hid_t space = H5Screate_simple(1, &total, nullptr);
  const hid_t part = H5Screate_simple(1, &count, nullptr);
  const hid_t set =
      H5Dcreate2(file, "x", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Sselect_hyperslab(space, H5S_SELECT_SET, &start, nullptr, &count, nullptr);
  H5Dwrite(set, H5T_NATIVE_DOUBLE, part, space, transfer, mine.data());
  H5Dclose(set);
  H5Sclose(part);
  H5Sclose(space);
  H5Fclose(file);
  H5Pclose(transfer);
  H5Pclose(access);
  if (ranks.rank == 0) on_disk(path);
}

}  // namespace

int main(int argc, char** argv) {
  if (bench::asks_for_help(argc, argv, "mpirun -np 2 output_benchmark FOLDER")) return 0;
  MPI_Init(&argc, &argv);
  Ranks ranks;
  MPI_Comm_rank(MPI_COMM_WORLD, &ranks.rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks.size);
  const std::string path = std::string(argc > 1 ? argv[1] : ".") + "/output_benchmark.h5";
  if (ranks.rank == 0) std::printf("ranks  cells  MB      gathered [s]  parallel [s]\n");
  for (const int n : {96, 192}) {
    const std::size_t cells = std::size_t(n) * n * (n / ranks.size);
    const std::vector<double> populations(19 * cells, 0.5 + ranks.rank);
    std::vector<double> best(2, 1e9);
    for (int trial = 0; trial < 3; ++trial) {
      best[0] = std::min(best[0], seconds([&] { gathered(path, populations, ranks); }));
      best[1] = std::min(best[1], seconds([&] { parallel(path, populations, ranks); }));
    }
    if (ranks.rank == 0)
      std::printf("%-6d %d³  %-7.0f %-13.3f %.3f\n", ranks.size, n, 152e-6 * cells * ranks.size,
                  best[0], best[1]);
  }
  if (ranks.rank == 0) std::remove(path.c_str());
  MPI_Finalize();
  return 0;
}
