// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/field_average.h"

#include <cmath>
#include <limits>

#include "lbm_solver/io/average_writer.h"

namespace lbm {

void FieldAverage::Moments::add(std::size_t cell, double value, double count) {
  const double before = value - mean[cell];
  mean[cell] += before / count;
  squares[cell] += before * (value - mean[cell]);
}

FieldAverage::FieldAverage(const AverageScene& scene, const Plan& plan, const Decomposition& ranks)
    : ranks_(ranks),
      times_(scene.every, plan.interval()),
      first_(first_state(scene.from, plan.interval())) {
  move_to(ranks);
}

void FieldAverage::move_to(const Decomposition& ranks) {
  ranks_ = ranks;
  const Cell3& n = ranks.cells().size;
  const std::size_t cells = static_cast<std::size_t>(n[0]) * n[1] * n[2];
  for (Moments* m : {&velocity_[0], &velocity_[1], &velocity_[2], &pressure_}) {
    m->mean.assign(cells, 0.0);
    m->squares.assign(cells, 0.0);
  }
  fluid_.assign(cells, 0.0);
}

void FieldAverage::add(double time, Fluid& fluid) {
  if (samples_ == 0) from_ = time;
  to_ = time;
  ++samples_;
  const Cell3& n = fluid.cells().size;
  const auto nx = static_cast<std::size_t>(n[0]);
  std::vector<double> rho(nx), u[3];
  for (auto& component : u) component.assign(nx, 0.0);
  const auto count = static_cast<double>(samples_);
  std::size_t cell = 0;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y) {
      fluid.row(y, z, rho, {u[0], u[1], u[2]});
      for (std::size_t x = 0; x < nx; ++x, ++cell) {
        for (int k = 0; k < fluid.lattice().D; ++k) velocity_[k].add(cell, u[k][x], count);
        if (std::isfinite(rho[x])) pressure_.add(cell, rho[x] - 1.0, ++fluid_[cell]);
      }
    }
}

void FieldAverage::write(const std::string& folder, const Units& units) const {
  if (samples_ == 0) return;
  const auto count = static_cast<double>(samples_);
  const CellFields fields{
      {{"velocity_mean", "m/s", 3},
       {"velocity_rms", "m/s", 3},
       {"pressure_mean", "Pa", 1},
       {"pressure_rms", "Pa", 1}},
      [&](const CellRange& piece, std::span<float> to) { fill(piece, to, units, count); }};
  write_averages(folder, {from_, to_, samples_, fields}, units, ranks_);
}

/// The four fields of a piece. The root mean square is that of the deviations; the pressure is not
/// a number where there never was fluid.
void FieldAverage::fill(const CellRange& piece, std::span<float> to, const Units& units,
                        double count) const {
  const auto single = [](double value, double unit) {
    return static_cast<float>(static_cast<float>(value) * unit);
  };
  const Cell3 &n = ranks_.cells().size, &first = ranks_.cells().begin;
  const std::size_t cells = piece.count();
  piece.each([&](const Cell3& c, std::size_t number) {
    const std::size_t row = static_cast<std::size_t>(c[2] - first[2]) * n[1] + c[1] - first[1];
    const std::size_t i = row * n[0] + c[0] - first[0];
    for (std::size_t k = 0; k < 3; ++k) {
      to[3 * number + k] = single(velocity_[k].mean[i], units.velocity());
      to[3 * (cells + number) + k] =
          single(std::sqrt(velocity_[k].squares[i] / count), units.velocity());
    }
    const bool none = fluid_[i] == 0.0;
    to[6 * cells + number] = none ? std::numeric_limits<float>::quiet_NaN()
                                  : single(pressure_.mean[i], units.pressure());
    to[7 * cells + number] = single(std::sqrt(pressure_.squares[i] / fluid_[i]), units.pressure());
  });
}

Record FieldAverage::save() const {
  Record record;
  record.set("samples", samples_);
  record.set("from", from_);
  record.set("to", to_);
  const auto keep = [&](const std::string& name, const Moments& m) {
    record.set(name + "_mean", ranks_.values_of(m.mean, 1));
    record.set(name + "_squares", ranks_.values_of(m.squares, 1));
  };
  for (int k = 0; k < ranks_.domain().dimension(); ++k)
    keep(std::string("u") + "xyz"[k], velocity_[k]);
  keep("pressure", pressure_);
  record.set("fluid", ranks_.values_of(fluid_, 1));
  return record;
}

void FieldAverage::load(const Record& record) {
  samples_ = record.integer("samples");
  from_ = record.real("from");
  to_ = record.real("to");
  const auto take = [&](const std::string& name) {
    return ranks_.own_values(record.cells(name, ranks_.domain().cells(), 1));
  };
  const auto restore = [&](const std::string& name, Moments& m) {
    m.mean = take(name + "_mean");
    m.squares = take(name + "_squares");
  };
  for (int k = 0; k < ranks_.domain().dimension(); ++k)
    restore(std::string("u") + "xyz"[k], velocity_[k]);
  restore("pressure", pressure_);
  fluid_ = take("fluid");
}

}  // namespace lbm
