// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/shown_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <variant>

#include "lbm_solver/solver/viscosity_use.h"

namespace lbm {
namespace {

/// Fills a piece field after field, a row of the fluid at a time.
class Painter {
 public:
  Painter(Fluid& fluid, const Plan& plan, const CellRange& piece, std::span<float> to,
          bool viscosity)
      : fluid_(fluid),
        plan_(plan),
        piece_(piece),
        nx_(static_cast<std::size_t>(piece.size[0])),
        rho_(nx_),
        nu_(nx_),
        u_{rho_, rho_, rho_} {
    const std::size_t cells = piece.count();
    pressure_ = to.first(cells);
    velocity_ = to.subspan(cells, 3 * cells);
    if (fluid.has_solids()) solid_ = to.subspan(4 * cells, cells);
    if (viscosity) viscosity_ = to.last(cells);
  }

  /// @param y, z  in the piece
  void row(int y, int z) {
    const Cell3& first = fluid_.cells().begin;
    const int row_y = piece_.begin[1] + y - first[1], row_z = piece_.begin[2] + z - first[2];
    const std::size_t at = nx_ * (static_cast<std::size_t>(z) * piece_.size[1] + y);
    const Units& units = plan_.units;
    fluid_.row(row_y, row_z, rho_, {u_[0], u_[1], u_[2]});
    for (std::size_t x = 0; x < nx_; ++x) {
      pressure_[at + x] = static_cast<float>((rho_[x] - 1.0) * units.pressure());
      for (std::size_t k = 0; k < 3; ++k)
        velocity_[3 * (at + x) + k] = static_cast<float>(u_[k][x] * units.velocity());
      if (!solid_.empty())
        solid_[at + x] =
            static_cast<float>(fluid_.solid_fraction(static_cast<int>(x), row_y, row_z));
    }
    if (viscosity_.empty()) return;
    row_viscosity(fluid_, plan_.kernel.parameters, row_y, row_z, nu_);
    for (std::size_t x = 0; x < nx_; ++x)
      viscosity_[at + x] = static_cast<float>(nu_[x] * (units.dx * units.dx / units.dt));
  }

 private:
  Fluid& fluid_;
  const Plan& plan_;
  const CellRange& piece_;
  const std::size_t nx_;
  std::vector<double> rho_, nu_;
  std::array<std::vector<double>, 3> u_;
  std::span<float> pressure_, velocity_, solid_, viscosity_;
};

}  // namespace

CellFields shown_cells(Fluid& fluid, const Plan& plan, bool viscosity) {
  CellFields shown{{{"pressure", "Pa", 1}, {"velocity", "m/s", 3}}, {}};
  if (fluid.has_solids()) shown.fields.push_back({"solid_fraction", "1", 1});
  if (viscosity) shown.fields.push_back({"viscosity", "m2/s", 1});
  shown.make = [&fluid, &plan, viscosity](const CellRange& piece, std::span<float> to) {
    Painter painter(fluid, plan, piece, to, viscosity);
    for (int z = 0; z < piece.size[2]; ++z)
      for (int y = 0; y < piece.size[1]; ++y) painter.row(y, z);
  };
  return shown;
}

std::vector<Geometry> image_solids(const Scene& scene, const Plan& plan) {
  std::vector<Geometry> images;
  if (std::ranges::none_of(scene.obstacles, [](const auto& o) { return o.image.has_value(); }))
    return images;
  for (Geometry& shape : obstacle_shapes(scene, plan))
    if (std::holds_alternative<VoxelSolid>(shape.shape)) images.push_back(std::move(shape));
  return images;
}

void add_images(const std::vector<Geometry>& images, const Fluid& fluid, CellFields& shown) {
  const Block cells = fluid.cells();
  const auto nx = static_cast<std::size_t>(cells.size[0]),
             ny = static_cast<std::size_t>(cells.size[1]);
  const auto covered = std::make_shared<std::vector<float>>(nx * ny * cells.size[2]);
  for (const Geometry& image : images)
    fill(image, fluid.domain(), cells, RadiusShift{}, [&](const FractionSpan& span) {
      float* row = covered->data() + nx * (ny * span.z + span.y) + span.x;
      for (std::size_t x = 0; x < span.fractions.size(); ++x)
        row[x] = std::min(1.0F, row[x] + static_cast<float>(span.fractions[x]));
    });
  shown.fields.push_back({"image_fraction", "1", 1});
  shown.make = [make = shown.make, covered, cells, nx, ny](const CellRange& piece,
                                                           std::span<float> to) {
    make(piece, to.first(to.size() - piece.count()));
    float* out = to.last(piece.count()).data();
    const auto row = [&](int y, int z) {
      const int from_y = piece.begin[1] - cells.begin[1] + y,
                from_z = piece.begin[2] - cells.begin[2] + z;
      return covered->data() + nx * (ny * from_z + from_y);
    };
    for (int z = 0; z < piece.size[2]; ++z)
      for (int y = 0; y < piece.size[1]; ++y, out += piece.size[0])
        std::copy_n(row(y, z) + piece.begin[0] - cells.begin[0], piece.size[0], out);
  };
}

namespace {

/// Of what is fluid in a cell.
Vec3 fluid_momentum(const Fluid& fluid, int x, int y, int z) {
  const double open = 1.0 - std::min(1.0, fluid.solid_fraction(x, y, z));
  if (open <= 0.0) return {};
  const Fluid::Cell cell = fluid.cell(x, y, z);
  return open * cell.rho * cell.u;
}

}  // namespace

Vec3 mean_arrived_momentum(const Fluid& fluid) {
  constexpr double kGrain = 0x1p-44;  // of the whole numbers
  constexpr double kMost = 8.0;       // a run stops long before
  constexpr double kHigh = 0x1p32;    // they are added up in two parts, so that none gets too large
  std::array<double, 6> sum{};
  const Cell3& n = fluid.cells().size;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y) {
      std::array<std::int64_t, 3> row{};
      for (int x = 0; x < n[0]; ++x) {
        const Vec3 arrived =
            fluid.steps() > 0 ? fluid.arrived_momentum(x, y, z) : fluid_momentum(fluid, x, y, z);
        for (int k = 0; k < 3; ++k)
          if (std::abs(arrived[k]) < kMost)
            row[k] += std::llround(static_cast<float>(arrived[k]) / kGrain);
      }
      for (int k = 0; k < 3; ++k) {
        const std::int64_t high = row[k] >> 32;
        sum[k] += static_cast<double>(high);
        sum[3 + k] += static_cast<double>(row[k] - (high << 32));
      }
    }
  fluid.ranks().sum(sum);
  const Cell3 all = fluid.domain().cells();
  const double cells = static_cast<double>(all[0]) * all[1] * all[2];
  Vec3 mean;
  for (int k = 0; k < 3; ++k) mean[k] = (sum[k] * kHigh + sum[3 + k]) * kGrain / cells;
  return mean;
}

}  // namespace lbm
