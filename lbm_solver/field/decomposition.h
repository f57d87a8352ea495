// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <mpi.h>

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "lbm_solver/base/record.h"
#include "lbm_solver/field/domain.h"

namespace lbm {

inline CellRange range_of(const Block& block) {
  return {block.begin, block.size};
}

/// Borders of the blocks along each axis, in cells: the first is 0 and the last the box's end.
using Cuts = std::array<std::vector<int>, 3>;
/// Blocks of about the same size.
Cuts equal_cuts(const Domain& domain, const Cell3& grid);
/// Borders along one axis between which the sums of what its layers hold are as equal as whole
/// layers let them, no part thinner than a block may be. @param layers  not negative
std::vector<int> cuts_of_equal_sums(std::span<const double> layers, int parts);

/// How the cells of the box are divided among the ranks of this program: a grid of blocks, equal or
/// with borders of their own. Rank 0 gathers what is written to files. All functions that say so
/// are collective: every rank calls them at the same place.
class Decomposition {
 public:
  /// The whole box on one rank; needs no MPI.
  explicit Decomposition(const Domain& domain);
  /// @param comm  all ranks of this program; must outlive the object
  /// @param grid  ranks along x, y, z; their product is the size of `comm`
  /// @throws std::invalid_argument where a rank would be left without two cells along an axis
  Decomposition(const Domain& domain, MPI_Comm comm, const Cell3& grid)
      : Decomposition(domain, comm, grid, equal_cuts(domain, grid)) {}
  Decomposition(const Domain& domain, MPI_Comm comm, const Cell3& grid, const Cuts& cuts);

  int rank() const { return rank_; }
  int size() const { return size_; }
  bool alone() const { return size_ == 1; }
  MPI_Comm comm() const { return comm_; }
  const Cell3& grid() const { return grid_; }
  const Cuts& cuts() const { return cuts_; }
  const Domain& domain() const { return domain_; }
  /// This rank's cells.
  const Block& cells() const { return cells_; }
  Block cells_of(int rank) const;
  /// Rank beyond a face, -1 where there is none or it is this one. @param high  0 low, 1 high
  int neighbour(int axis, int high) const;

  /// Sum over ranks in rank order, of each number; on every rank. Collective.
  void sum(std::span<double> values) const;
  /// Largest over ranks; on every rank. Collective.
  double max(double value) const;

  /// Fills the numbers of a piece of this rank's cells; and what rank 0 does with those of any.
  template <class T>
  using MakePiece = std::function<void(const CellRange&, std::span<T>)>;
  template <class T>
  using TakePiece = std::function<void(const CellRange&, std::span<const T>)>;
  /// Numbers of every cell on rank 0, a piece after another, the ranks' own in rank order: no rank
  /// needs room for more than one. `take` is called on rank 0 alone. Collective.
  template <class T>
  void in_pieces(int numbers_a_cell, const MakePiece<T>& make, const TakePiece<T>& take) const;
  /// A list of this rank's cells, [z][y][x][components], as values of the box; it must outlive
  /// them. And such a list from the values of any other ranks.
  CellValues values_of(const std::vector<double>& mine, int components) const;
  std::vector<double> own_values(const CellValues& values) const;

  /// The lists of all ranks in rank order, on rank 0 (elsewhere empty). Collective.
  std::vector<double> collect(const std::vector<double>& local) const;
  /// Lists of equal lengths, one of each rank, of which the sum over the ranks counts: on rank 0
  /// the grid of ranks and all lists. Collective.
  std::vector<double> collect_parts(const std::vector<double>& part) const;
  /// This rank's list again; on another grid the first rank gets the sum of all, the others zeros.
  /// @throws std::invalid_argument  they are of another length
  std::vector<double> own_part(std::span<const double> collected, std::size_t length) const;
  /// Gives a list to the rank beyond each face of an axis that has one, and takes that rank's in
  /// its place, of the same length. @param lists  [low, high] Collective.
  void exchange(int axis, std::vector<float> (&lists)[2]) const;
  /// Rank 0's list, on every rank. Collective.
  void broadcast(std::vector<double>& values) const;

 private:
  Cell3 place_of(int rank) const;

  Domain domain_;
  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
  Cell3 grid_{1, 1, 1};
  Cuts cuts_;
  Block cells_;
};

/// Whether a place of the box, or the cell of the box that is nearest to it, is among these cells:
/// of the blocks of a grid exactly one says yes.
bool holds(const Domain& domain, const Block& cells, const Vec3& place);

/// The grid of `ranks` blocks whose surface is smallest; of equals the one that cuts z, then y:
/// rows along x stay whole, and only layers across the last axis can be exchanged during a sweep.
Cell3 choose_grid(const Domain& domain, int ranks);

}  // namespace lbm
