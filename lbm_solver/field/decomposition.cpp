// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/field/decomposition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace lbm {
namespace {

constexpr int kTag = 7101, kFaceTag = 7120;
constexpr int kLeastCells = 2;  // along an axis that is cut: boundaries look one cell inward

template <class T>
MPI_Datatype type_of() {
  if constexpr (std::is_same_v<T, float>)
    return MPI_FLOAT;
  else
    return MPI_DOUBLE;
}

}  // namespace

Cuts equal_cuts(const Domain& domain, const Cell3& grid) {
  Cuts cuts;
  for (int a = 0; a < 3; ++a)
    for (int p = 0; p <= grid[a]; ++p)
      cuts[a].push_back(static_cast<int>(static_cast<long long>(domain.cells()[a]) * p / grid[a]));
  return cuts;
}

std::vector<int> cuts_of_equal_sums(std::span<const double> layers, int parts) {
  const int n = static_cast<int>(layers.size());
  std::vector<double> below{0.0};  // [border]
  for (const double layer : layers) below.push_back(below.back() + layer);
  std::vector<int> cuts{0};
  for (int p = 1; p < parts; ++p) {
    const double wanted = below.back() * p / parts;
    const auto above = std::lower_bound(below.begin(), below.end(), wanted);
    int cut = static_cast<int>(above - below.begin());
    if (cut > 0 && wanted - below[cut - 1] < *above - wanted) --cut;
    cuts.push_back(std::clamp(cut, cuts.back() + kLeastCells, n - kLeastCells * (parts - p)));
  }
  cuts.push_back(n);
  return cuts;
}

Decomposition::Decomposition(const Domain& domain)
    : domain_(domain), cuts_(equal_cuts(domain, grid_)), cells_(Block::whole(domain)) {}

Decomposition::Decomposition(const Domain& domain, MPI_Comm comm, const Cell3& grid,
                             const Cuts& cuts)
    : domain_(domain), comm_(comm), grid_(grid), cuts_(cuts) {
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &size_);
  for (int a = 0; a < 3; ++a) {
    bool fits = cuts[a].size() == static_cast<std::size_t>(grid[a]) + 1 && cuts[a].front() == 0 &&
                cuts[a].back() == domain.cells()[a];
    for (int p = 0; fits && grid[a] > 1 && p < grid[a]; ++p)
      fits = cuts[a][p + 1] - cuts[a][p] >= kLeastCells;
    if (!fits)
      throw std::invalid_argument(std::to_string(grid[a]) + " ranks along " + "xyz"[a] + " for " +
                                  std::to_string(domain.cells()[a]) + " cells");
  }
  if (grid[0] * grid[1] * grid[2] != size_)
    throw std::invalid_argument("the grid of ranks has not as many as there are");
  cells_ = cells_of(rank_);
}

Cell3 Decomposition::place_of(int rank) const {
  return {rank % grid_[0], rank / grid_[0] % grid_[1], rank / (grid_[0] * grid_[1])};
}

Block Decomposition::cells_of(int rank) const {
  const Cell3 place = place_of(rank);
  Block block = Block::whole(domain_);
  for (int a = 0; a < 3; ++a) {
    block.begin[a] = cuts_[a][place[a]];
    block.size[a] = cuts_[a][place[a] + 1] - block.begin[a];
    if (grid_[a] == 1) continue;
    const bool wall = domain_.sides()[a] == Side::Wall;
    block.faces[a][0] = wall && place[a] == 0 ? Face::Wall : Face::Neighbour;
    block.faces[a][1] = wall && place[a] == grid_[a] - 1 ? Face::Wall : Face::Neighbour;
  }
  return block;
}

int Decomposition::neighbour(int axis, int high) const {
  if (cells_.faces[axis][high] != Face::Neighbour) return -1;
  Cell3 place = place_of(rank_);
  place[axis] = (place[axis] + (high ? 1 : grid_[axis] - 1)) % grid_[axis];
  return place[0] + grid_[0] * (place[1] + grid_[1] * place[2]);
}

void Decomposition::sum(std::span<double> values) const {
  if (alone()) return;
  const int n = static_cast<int>(values.size());
  std::vector<double> all(rank_ == 0 ? values.size() * size_ : 0);
  MPI_Gather(values.data(), n, MPI_DOUBLE, all.data(), n, MPI_DOUBLE, 0, comm_);
  if (rank_ == 0) {
    std::fill(values.begin(), values.end(), 0.0);
    for (std::size_t i = 0; i < all.size(); ++i) values[i % values.size()] += all[i];
  }
  MPI_Bcast(values.data(), n, MPI_DOUBLE, 0, comm_);
}

void Decomposition::exchange(int axis, std::vector<float> (&lists)[2]) const {
  if (alone()) return;
  MPI_Request requests[] = {MPI_REQUEST_NULL, MPI_REQUEST_NULL, MPI_REQUEST_NULL, MPI_REQUEST_NULL};
  std::vector<float> arrived[2];
  for (int high = 0; high < 2; ++high) {
    const int rank = neighbour(axis, high), n = static_cast<int>(lists[high].size());
    if (rank < 0) continue;
    arrived[high].resize(lists[high].size());
    // what leaves through a high face arrives through a low one
    MPI_Irecv(arrived[high].data(), n, MPI_FLOAT, rank, kFaceTag + 1 - high, comm_,
              &requests[high]);
    MPI_Isend(lists[high].data(), n, MPI_FLOAT, rank, kFaceTag + high, comm_, &requests[2 + high]);
  }
  MPI_Waitall(4, requests, MPI_STATUSES_IGNORE);
  for (int high = 0; high < 2; ++high)
    if (neighbour(axis, high) >= 0) lists[high].swap(arrived[high]);
}

double Decomposition::max(double value) const {
  if (!alone()) MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, comm_);
  return value;
}

template <class T>
void Decomposition::in_pieces(int numbers_a_cell, const MakePiece<T>& make,
                              const TakePiece<T>& take) const {
  std::vector<T> values;
  const auto numbers = static_cast<std::size_t>(numbers_a_cell);
  for (int r = 0; r < size_; ++r) {
    if (rank_ != 0 && rank_ != r) continue;
    for (const CellRange& piece : pieces_of(range_of(cells_of(r)), numbers * sizeof(T))) {
      values.resize(numbers * piece.count());
      const int count = static_cast<int>(values.size());
      if (r == rank_)
        make(piece, values);
      else
        MPI_Recv(values.data(), count, type_of<T>(), r, kTag, comm_, MPI_STATUS_IGNORE);
      if (rank_ == 0)
        take(piece, values);
      else
        MPI_Send(values.data(), count, type_of<T>(), 0, kTag, comm_);
    }
  }
}

template void Decomposition::in_pieces(int, const MakePiece<float>&, const TakePiece<float>&) const;
template void Decomposition::in_pieces(int, const MakePiece<double>&,
                                       const TakePiece<double>&) const;

CellValues Decomposition::values_of(const std::vector<double>& mine, int components) const {
  const Cell3 n = cells_.size, first = cells_.begin;
  const auto read = [list = mine.data(), n, first, components](const CellRange& piece,
                                                               std::span<double> to) {
    const auto count = static_cast<std::size_t>(components);
    piece.each([&](const Cell3& c, std::size_t number) {
      const std::size_t row = static_cast<std::size_t>(c[2] - first[2]) * n[1] + c[1] - first[1];
      std::copy_n(list + (row * n[0] + c[0] - first[0]) * count, count,
                  to.begin() + static_cast<std::ptrdiff_t>(number * count));
    });
  };
  return {domain_.cells(), components, false, range_of(cells_), read};
}

std::vector<double> Decomposition::own_values(const CellValues& values) const {
  const CellRange mine = range_of(cells_);
  if (!values.here.holds(mine)) throw std::invalid_argument("values are of cells of another rank");
  const auto count = static_cast<std::size_t>(values.components);
  std::vector<double> list(count * mine.count());
  std::size_t done = 0;  // pieces are in the order of the list
  for (const CellRange& piece : pieces_of(mine, count * sizeof(double))) {
    values.read(piece, std::span(list).subspan(done, count * piece.count()));
    done += count * piece.count();
  }
  return list;
}

std::vector<double> Decomposition::collect(const std::vector<double>& local) const {
  if (alone()) return local;
  const int n = static_cast<int>(local.size());
  std::vector<int> counts(size_), starts(size_, 0);
  MPI_Gather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm_);
  for (int r = 1; r < size_; ++r) starts[r] = starts[r - 1] + counts[r - 1];
  std::vector<double> all(rank_ == 0 ? starts.back() + counts.back() : 0);
  MPI_Gatherv(local.data(), n, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE, 0,
              comm_);
  return all;
}

std::vector<double> Decomposition::collect_parts(const std::vector<double>& part) const {
  std::vector<double> all(grid_.begin(), grid_.end());
  const std::vector<double> parts = collect(part);
  if (rank_ != 0) return {};
  all.insert(all.end(), parts.begin(), parts.end());
  return all;
}

std::vector<double> Decomposition::own_part(std::span<const double> collected,
                                            std::size_t length) const {
  std::vector<double> part(length, 0.0);
  if (collected.size() < 3 || length == 0 || (collected.size() - 3) % length != 0)
    throw std::invalid_argument("sums of ranks are of another size");
  const bool same_grid = std::equal(grid_.begin(), grid_.end(), collected.begin());
  const std::span<const double> parts = collected.subspan(3);
  if (same_grid && parts.size() == length * static_cast<std::size_t>(size_)) {
    std::copy_n(parts.begin() + static_cast<std::ptrdiff_t>(length) * rank_, length, part.begin());
    return part;
  }
  for (std::size_t k = 0; rank_ == 0 && k < parts.size(); ++k) part[k % length] += parts[k];
  return part;
}

void Decomposition::broadcast(std::vector<double>& values) const {
  if (alone()) return;
  auto n = static_cast<unsigned long long>(values.size());
  MPI_Bcast(&n, 1, MPI_UNSIGNED_LONG_LONG, 0, comm_);
  values.resize(n);
  MPI_Bcast(values.data(), static_cast<int>(n), MPI_DOUBLE, 0, comm_);
}

bool holds(const Domain& domain, const Block& cells, const Vec3& place) {
  Cell3 cell{0, 0, 0};
  for (int a = 0; a < domain.dimension(); ++a) {
    const int n = domain.cells()[a], at = static_cast<int>(std::floor(place[a]));
    cell[a] = domain.sides()[a] == Side::Periodic ? ((at % n) + n) % n : std::clamp(at, 0, n - 1);
  }
  return cells.holds(cell);
}

Cell3 choose_grid(const Domain& domain, int ranks) {
  const Cell3 n = domain.cells();
  Cell3 best{0, 0, 0};
  double least = std::numeric_limits<double>::infinity();
  for (int x = 1; x <= ranks; ++x)
    for (int y = 1; x * y <= ranks; ++y) {
      const int z = ranks / (x * y);
      const Cell3 grid{x, y, z};
      if (x * y * z != ranks) continue;
      double surface = 0.0;  // of the cuts, over the box's volume
      bool fits = true;
      for (int a = 0; a < 3; ++a) {
        if (grid[a] > 1) surface += static_cast<double>(grid[a]) / n[a];
        fits = fits && (grid[a] == 1 || n[a] / grid[a] >= kLeastCells);
      }
      if (!fits || surface > least * (1.0 - 1e-12)) continue;  // later ones cut more of x and y
      least = surface;
      best = grid;
    }
  if (best[0] == 0)
    throw std::invalid_argument(std::to_string(ranks) + " ranks for a box of " +
                                std::to_string(n[0]) + " × " + std::to_string(n[1]) + " × " +
                                std::to_string(n[2]) + " cells");
  return best;
}

}  // namespace lbm
