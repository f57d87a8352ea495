// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/field/halo_exchange.h"

#include <algorithm>

namespace lbm {
namespace {

constexpr int kTag = 7110;

std::size_t size_of(const Populations& f) {
  return f.precision() == Precision::Double ? sizeof(double) : sizeof(float);
}

}  // namespace

HaloExchange::HaloExchange(const Decomposition& ranks, const Populations& f) : ranks_(ranks) {
  for (int axis = 2; axis >= 0; --axis)
    if (ranks.grid()[axis] > 1) axes_.push_back(axis);
  const EsotericPull stream(ranks.cells().faces);
  for (const int axis : axes_)
    for (int high = 0; high < 2; ++high) {
      if (ranks.neighbour(axis, high) < 0) continue;
      ++messages_;
      for (const Part& p : parts(axis, high, true, f, stream)) {
        std::size_t cells = 1;
        for (int a = 0; a < 3; ++a)
          if (a != axis) cells *= p.to[a] - p.from[a];
        bytes_ += cells * size_of(f);
      }
    }
}

/// What is sent through a face, or received: for a pair that points through it, the place in the
/// ghost layer of the side that it leaves and in the outermost cells of the other; for one that
/// points the other way the same with the roles exchanged.
std::vector<HaloExchange::Part> HaloExchange::parts(int axis, int high, bool sending,
                                                    const Populations& f,
                                                    const EsotericPull& stream) const {
  std::vector<Part> list;
  const Faces& faces = stream.faces();
  const int n = f.cells()[axis];
  const int ghost = high ? n : -1, outermost = high ? n - 1 : 0;
  for (int i = 1; i < f.lattice().Q; i += 2) {
    const int* c = f.lattice().c[i];
    if (c[axis] == 0) continue;
    const bool outward = (c[axis] > 0) == (high == 1);
    // Outward pairs: what was written in our ghost layer goes home; what the owner wrote comes.
    // Inward pairs: our own cells are the owners.
    const auto [own, next] = stream.slots(i);
    Part part;
    part.layer = outward ? ghost : outermost;
    part.slot = outward == sending ? next : own;
    for (int a = 0; a < 3; ++a) {
      const auto& [low, top] = faces[a];
      const int cells = f.cells()[a];
      part.from[a] = low == Face::Wall ? std::max(0, c[a]) : low == Face::Neighbour ? -1 : 0;
      part.to[a] = top == Face::Wall        ? cells + std::min(0, c[a])
                   : top == Face::Neighbour ? cells + 1
                                            : cells;
    }
    list.push_back(part);
  }
  return list;
}

namespace {

/// Calls f(start, count) for every run of places along x of a part.
template <class Part, class F>
void each_run(int axis, Part part, const Populations& f, F&& run) {
  part.from[axis] = part.layer;
  part.to[axis] = part.layer + 1;
  for (int z = part.from[2]; z < part.to[2]; ++z)
    for (int y = part.from[1]; y < part.to[1]; ++y)
      run(f.start(part.slot, y, z) + part.from[0], part.to[0] - part.from[0]);
}

}  // namespace

template <class Real>
void HaloExchange::pack(int axis, int high, const Populations& f, const EsotericPull& stream) {
  const std::vector<Part> list = parts(axis, high, true, f, stream);
  std::size_t numbers = 0;
  for (const Part& part : list)
    each_run(axis, part, f, [&](std::ptrdiff_t, int count) { numbers += count; });
  out_[high].resize(numbers * sizeof(Real));
  Real* to = reinterpret_cast<Real*>(out_[high].data());
  const Real* const memory = f.row<Real>(0, 0, 0) - f.start(0, 0, 0);
  for (const Part& part : list)
    each_run(axis, part, f, [&](std::ptrdiff_t at, int count) {
      for (int k = 0; k < count; ++k) *to++ = memory[at + k];
    });
}

template <class Real>
void HaloExchange::unpack(int axis, int high, Populations& f, const EsotericPull& stream) {
  const Real* from = reinterpret_cast<const Real*>(in_[high].data());
  Real* const memory = f.row<Real>(0, 0, 0) - f.start(0, 0, 0);
  for (const Part& part : parts(axis, high, false, f, stream))
    each_run(axis, part, f, [&](std::ptrdiff_t at, int count) {
      for (int k = 0; k < count; ++k) memory[at + k] = *from++;
    });
}

void HaloExchange::begin(int axis, const Populations& f, const EsotericPull& stream) {
  std::fill(std::begin(requests_), std::end(requests_), MPI_REQUEST_NULL);
  for (int high = 0; high < 2; ++high) {
    const int rank = ranks_.neighbour(axis, high);
    if (rank < 0) continue;
    if (f.precision() == Precision::Double)
      pack<double>(axis, high, f, stream);
    else
      pack<float>(axis, high, f, stream);
    in_[high].resize(out_[high].size());
    // A message through the high face arrives through the low one: two ranks may be neighbours
    // twice.
    MPI_Irecv(in_[high].data(), static_cast<int>(in_[high].size()), MPI_BYTE, rank,
              kTag + 2 * axis + 1 - high, ranks_.comm(), &requests_[high]);
    MPI_Isend(out_[high].data(), static_cast<int>(out_[high].size()), MPI_BYTE, rank,
              kTag + 2 * axis + high, ranks_.comm(), &requests_[2 + high]);
  }
}

void HaloExchange::finish(int axis, Populations& f, const EsotericPull& stream) {
  const double begin = MPI_Wtime();
  MPI_Waitall(4, requests_, MPI_STATUSES_IGNORE);
  waited_ += MPI_Wtime() - begin;
  for (int high = 0; high < 2; ++high) {
    if (ranks_.neighbour(axis, high) < 0) continue;
    if (f.precision() == Precision::Double)
      unpack<double>(axis, high, f, stream);
    else
      unpack<float>(axis, high, f, stream);
  }
}

}  // namespace lbm
