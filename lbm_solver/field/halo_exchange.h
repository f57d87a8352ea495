// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "lbm_solver/field/decomposition.h"
#include "lbm_solver/field/esoteric_pull.h"

namespace lbm {

/// Brings populations across the faces between ranks after a sweep. With in-place streaming a cell
/// at a face uses one place beyond it for each pair of directions that crosses: what it wrote there
/// goes home to the cell that owns the place, and what that cell wrote at its own place comes back
/// to be read in the next step. So a face carries each crossing population once, whatever the
/// lattice.
///
/// Axes are exchanged one after another, each with the ghost cells of those before, so that edges
/// and corners need no messages of their own. A message is posted by `begin` and used by `finish`;
/// between them cells may be swept that do not touch the face.
class HaloExchange {
 public:
  HaloExchange(const Decomposition& ranks, const Populations& f);

  /// Axes that are cut, the one to be exchanged during the sweep first.
  const std::vector<int>& axes() const { return axes_; }

  /// After the cells at both faces of an axis were swept, before `stream.advance()`.
  void begin(int axis, const Populations& f, const EsotericPull& stream);
  void finish(int axis, Populations& f, const EsotericPull& stream);

  /// Sent in a step by this rank.
  std::size_t messages() const { return messages_; }
  std::size_t bytes() const { return bytes_; }
  /// Seconds that this rank has waited for its neighbours so far.
  double waited() const { return waited_; }

 private:
  /// Places of one pair of directions in a layer of cells.
  struct Part {
    int slot, layer;
    Cell3 from, to;  ///< in the axes across; the axis itself is `layer`
  };
  std::vector<Part> parts(int axis, int high, bool sending, const Populations& f,
                          const EsotericPull& stream) const;
  template <class Real>
  void pack(int axis, int high, const Populations& f, const EsotericPull& stream);
  template <class Real>
  void unpack(int axis, int high, Populations& f, const EsotericPull& stream);

  const Decomposition& ranks_;
  std::vector<int> axes_;
  std::vector<char> out_[2], in_[2];
  MPI_Request requests_[4];
  std::size_t messages_ = 0, bytes_ = 0;
  double waited_ = 0.0;
};

}  // namespace lbm
