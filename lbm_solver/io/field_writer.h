// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lbm_solver/base/units.h"
#include "lbm_solver/io/cell_fields.h"
#include "lbm_solver/io/shown_obstacles.h"
#include "protocol/wire/session.h"

namespace lbm {

/// One picture of the fluid and its particles, SI units.
struct FieldFrame {
  double time = 0.0;  ///< [s]
  /// pressure against rest and hydrostatic [Pa], velocity [m/s] and, where there are any, solid
  /// fraction and kinematic viscosity [m²/s]; in the first frame of a file what images cover
  CellFields cells;
  /// Mean over the box of the momentum that has arrived, over the density at rest [m/s]: in steady
  /// flow the flux through every face of the box, covered cells too, under every solid term
  /// (docs/output.md, "Flux").
  std::optional<Vec3> flux;
  std::vector<protocol::Particle> particles;
  std::vector<protocol::Load> loads;  ///< on them, in their order
  std::vector<double> bond_ends;      ///< [n][2][dimension]: of both centres [m]
  std::vector<double> bond_state;     ///< [n]: 0 intact, 1 broken by tension, 2 by shear
};

/// Writes frames to `fields.h5` and keeps `fields.xdmf` beside it, which ParaView opens: fluid,
/// particles, bonds and broken bonds, obstacles where they are, in two dimensions all in the x-y
/// plane, with the fluid as a layer one cell thick just behind the particles. (ParaView's readers
/// put a two-dimensional mesh of this kind into the y-z plane.) A reader shows the frame before
/// where a block has none: one without particles (bonds) has a particle of radius 0 (a bond of
/// length 0) in the lower corner. `view.py` beside it makes a picture, or the scene in ParaView, of
/// all of it. Every array names its unit, every table its columns, as attributes. The file is
/// closed after every frame: a kill loses the frame in progress, seldom (while the file is being
/// closed) makes the file unreadable; a restart then puts it aside and begins a new one.
class FieldWriter {
 public:
  /// @param folder      must exist
  /// @param keep_until  a run that goes on keeps the frames before this time
  FieldWriter(const std::string& folder, const Units& units, int dimension = 2,
              double keep_until = 0.0, ShownObstacles obstacles = {});
  /// The next frame is the first one of its file.
  bool at_first() const { return entries_.empty(); }
  /// Collective: other ranks than the first, which alone has a writer, call `send_fields`.
  void write(const FieldFrame& frame, const Decomposition& ranks);

 private:
  void write_xdmf() const;
  void write_view() const;
  std::string nothing(const char* name, double time) const;
  std::string fluid_grid(std::size_t index) const;
  std::string particle_grid(std::size_t index) const;
  std::string bond_grid(std::size_t index, bool broken) const;
  bool keep_frames(double until);
  struct Entry {
    double time;
    int nx, ny, nz;
    bool solids, viscosity, images, clumps;
    std::size_t particles;
    std::vector<double> bonds;  // their states
  };
  std::vector<unsigned long long> shape(const Entry& entry) const;
  std::string shape_text(const Entry& entry, int more) const;

  std::string folder_;
  Units units_;
  int dimension_;
  std::vector<Entry> entries_;
  ShownObstacles obstacles_;
};

}  // namespace lbm
