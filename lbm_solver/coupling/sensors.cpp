// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/sensors.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

namespace lbm {
namespace {

/// "ux [m/s],uy [m/s]": a column each axis.
std::string columns_of(const char* name, const char* unit, int dimension) {
  std::string text;
  for (int k = 0; k < dimension; ++k) text += fmt::format(",{}{} [{}]", name, "xyz"[k], unit);
  return text;
}

/// The layer of cells beyond the plane nearest to a place; at a wall the first plane inside.
int plane_at(const Units& units, const Domain& domain, int axis, double place) {
  const int n = domain.cells()[axis];
  const auto plane = static_cast<int>(std::lround((place - units.origin[axis]) / units.dx));
  if (domain.sides()[axis] == Side::Periodic) return plane % n;
  return std::clamp(plane, 1, n - 1);
}

/// The layer of cells beyond a plane: along it those whose centres lie between its corners.
CellBox layer_of(const SensorScene& s, const Units& units, const Domain& domain) {
  CellBox layer;
  for (int k = 0; k < domain.dimension(); ++k) {
    const auto after = [&](double x) {  // first cell whose centre is not before x
      const double centre = (x - units.origin[k]) / units.dx - 0.5;
      return std::clamp(static_cast<int>(std::ceil(centre - 1e-9)), 0, domain.cells()[k]);
    };
    layer.from[k] = k == s.axis ? plane_at(units, domain, k, s.at) : after(s.from[k]);
    layer.to[k] = k == s.axis ? layer.from[k] + 1 : after(s.to[k]);
  }
  return layer;
}

/// That beyond the plane next to a side.
CellBox layer_of(SideName side, const Domain& domain) {
  CellBox layer{{0, 0, 0}, domain.cells()};
  const int axis = axis_of(side);
  layer.from[axis] = is_high(side) ? domain.cells()[axis] - 1 : 1;
  layer.to[axis] = layer.from[axis] + 1;
  return layer;
}

/// Area of a cell's face [m²].
double face(const Units& units) {
  return units.dx * units.depth;
}

class LineSensor final : public Sensor {
 public:
  using Sensor::Sensor;
  void write(double time, Fluid& fluid) override {
    const int d = box_.dimension;
    open_table("time [s],distance [m]" + columns_of("", "m", d) + ",pressure [Pa]" +
               columns_of("u", "m/s", d));
    for (int i = 0; i < scene_.count; ++i) {
      const Vec3 way = (scene_.to - scene_.from) * (static_cast<double>(i) / (scene_.count - 1));
      const Vec3 x = scene_.from + way;
      const Fluid::Cell c = fluid.at(units_.to_lattice_position(x));
      std::vector<double> row{time, way.norm()};
      row.insert(row.end(), x.begin(), x.begin() + d);
      row.push_back((c.rho - 1.0) * units_.pressure());
      for (int k = 0; k < d; ++k) row.push_back(c.u[k] * units_.velocity());
      if (table_) table_->row(row);
    }
    if (table_) table_->flush();
  }
};

class PlaneSensor final : public Sensor {
 public:
  using Sensor::Sensor;
  void write(double time, Fluid& fluid) override {
    const int d = box_.dimension;
    open_table("time [s],flow [m3/s]" + columns_of("momentum_", "N", d) +
               ",pressure [Pa],fluid_area [m2]");
    PlaneFlow sum = PlaneFlow::of(fluid, layer_of(scene_, units_, ranks_.domain()), scene_.axis);
    std::array<double, 6> all{sum.volume,      sum.momentum[0], sum.momentum[1],
                              sum.momentum[2], sum.pressure,    sum.area};
    ranks_.sum(all);
    const double area = face(units_), speed = units_.velocity();
    std::vector<double> row{time, all[0] * speed * area};
    for (int k = 0; k < d; ++k) row.push_back(all[1 + k] * units_.density * speed * speed * area);
    row.push_back(all[4] / all[5] * units_.pressure());  // not a number where there is no fluid
    row.push_back(all[5] * area);
    if (table_) table_->row(row);
    if (table_) table_->flush();
  }
};

/// Flow through the plane next to a side, one cell inside, as a plane sensor there has it in the
/// row of the same time, and the mean force on its walls since the row before. What crosses the
/// plane has come through the side a step earlier: of a sudden start the first row shows nothing.
class SideSensor final : public Sensor {
 public:
  using Sensor::Sensor;
  bool sums() const override { return true; }
  void add(const Fluid& fluid) override {
    if (!loads_) loads_ = std::make_unique<SideLoads>(fluid, scene_.side);
    sum_ += loads_->force(fluid);
    ++steps_;
  }
  void write(double time, Fluid& fluid) override {
    const int d = box_.dimension, axis = axis_of(scene_.side);
    open_table("time [s],flow [m3/s]" + columns_of("f", "N", d));
    if (steps_ == 0) return;
    std::array<double, 4> all{
        PlaneFlow::of(fluid, layer_of(scene_.side, ranks_.domain()), axis).volume, sum_[0], sum_[1],
        sum_[2]};
    ranks_.sum(all);
    std::vector<double> row{time, all[0] * units_.velocity() * face(units_)};
    for (int k = 0; k < d; ++k) row.push_back(all[1 + k] * units_.force() / steps_);
    if (table_) table_->row(row);
    if (table_) table_->flush();
    sum_ = Vec3::Zero();
    steps_ = 0;
  }
  Record save() const override {
    Record record;
    record.set("steps", std::int64_t{steps_});
    record.set("force_sum", ranks_.collect_parts({sum_[0], sum_[1], sum_[2]}));
    return record;
  }
  void load(const Record& record) override {
    const auto sum = ranks_.own_part(record.get<std::vector<double>>("force_sum"), 3);
    sum_ = {sum[0], sum[1], sum[2]};
    steps_ = static_cast<int>(record.integer("steps"));
  }
  void move_to(const Decomposition& ranks) override {
    Sensor::move_to(ranks);
    loads_.reset();
  }

 private:
  std::unique_ptr<SideLoads> loads_;  // from the first step on
  Vec3 sum_ = Vec3::Zero();           // since the last row, of this rank
  int steps_ = 0;
};

}  // namespace

Sensor::Sensor(const SensorScene& scene, const BoxScene& box, const Plan& plan,
               const Decomposition& ranks, const std::string& folder, double keep_until)
    : scene_(scene),
      box_(box),
      units_(plan.units),
      ranks_(ranks),
      path_(folder + "/sensor-" + scene.name + ".csv"),
      keep_until_(keep_until),
      times_(scene.every, plan.interval()) {}

void Sensor::open_table(const std::string& columns) {
  if (!table_ && ranks_.rank() == 0)
    table_ = std::make_unique<CsvWriter>(path_, columns, keep_until_);
}

std::vector<std::unique_ptr<Sensor>> make_sensors(const Scene& scene, const Plan& plan,
                                                  const Decomposition& ranks,
                                                  const std::string& folder, double keep_until) {
  using Kind = SensorScene::Kind;
  std::vector<std::unique_ptr<Sensor>> sensors;
  const auto add = [&]<class Made>(std::type_identity<Made>, const SensorScene& s) {
    sensors.push_back(std::make_unique<Made>(s, scene.box, plan, ranks, folder, keep_until));
  };
  for (const SensorScene& s : scene.output.sensors)
    s.kind == Kind::Line    ? add(std::type_identity<LineSensor>(), s)
    : s.kind == Kind::Plane ? add(std::type_identity<PlaneSensor>(), s)
                            : add(std::type_identity<SideSensor>(), s);
  return sensors;
}

}  // namespace lbm
