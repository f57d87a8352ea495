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

/// Of the deviations; not a number where nothing was counted.
std::vector<float> FieldAverage::rms(const Moments& of, const std::vector<double>* counts) const {
  std::vector<float> values;
  for (std::size_t i = 0; i < of.squares.size(); ++i) {
    const double count = counts ? (*counts)[i] : static_cast<double>(samples_);
    values.push_back(static_cast<float>(std::sqrt(of.squares[i] / count)));
  }
  return values;
}

void FieldAverage::write(const std::string& folder, const Units& units) const {
  if (samples_ == 0) return;
  const auto scaled = [](std::vector<float> values, double unit) {
    for (float& v : values) v = static_cast<float>(v * unit);
    return values;
  };
  const auto vectors = [&](const std::array<std::vector<float>, 3>& components) {
    std::vector<float> all;
    for (std::size_t i = 0; i < components[0].size(); ++i)
      for (const auto& component : components)
        all.push_back(static_cast<float>(component[i] * units.velocity()));
    return ranks_.gather(std::move(all), 3);
  };
  const auto single = [](const std::vector<double>& v) {
    return std::vector<float>(v.begin(), v.end());
  };
  FieldAverages a{from_, to_, samples_, {}, {}, {}, {}};
  a.velocity_mean =
      vectors({single(velocity_[0].mean), single(velocity_[1].mean), single(velocity_[2].mean)});
  a.velocity_rms =
      vectors({rms(velocity_[0], nullptr), rms(velocity_[1], nullptr), rms(velocity_[2], nullptr)});
  std::vector<float> pressure = single(pressure_.mean);
  for (std::size_t i = 0; i < pressure.size(); ++i)
    if (fluid_[i] == 0.0) pressure[i] = std::numeric_limits<float>::quiet_NaN();
  a.pressure_mean = ranks_.gather(scaled(std::move(pressure), units.pressure()), 1);
  a.pressure_rms = ranks_.gather(scaled(rms(pressure_, &fluid_), units.pressure()), 1);
  if (ranks_.rank() == 0) write_averages(folder, a, units, ranks_.domain());
}

Record FieldAverage::save() const {
  Record record;
  record.set("samples", samples_);
  record.set("from", from_);
  record.set("to", to_);
  const auto keep = [&](const std::string& name, const Moments& m) {
    record.set(name + "_mean", ranks_.gather(m.mean, 1));
    record.set(name + "_squares", ranks_.gather(m.squares, 1));
  };
  for (int k = 0; k < ranks_.domain().dimension(); ++k)
    keep(std::string("u") + "xyz"[k], velocity_[k]);
  keep("pressure", pressure_);
  record.set("fluid", ranks_.gather(fluid_, 1));
  return record;
}

void FieldAverage::load(const Record& record) {
  samples_ = record.integer("samples");
  from_ = record.real("from");
  to_ = record.real("to");
  const Cell3 n = ranks_.domain().cells();
  const std::size_t cells = static_cast<std::size_t>(n[0]) * n[1] * n[2];
  const auto take = [&](const std::string& name) {
    return ranks_.scatter(record.list<double>(name, cells), 1);
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
