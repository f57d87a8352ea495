// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/pressure_control.h"

#include <algorithm>
#include <cmath>

namespace lbm {
namespace {

constexpr double kCrossings = 8.0;
constexpr double kFastest = 0.25;  // of Z: what one look may add to I for a velocity

}  // namespace

PressureControl::PressureControl(std::size_t patch, double flow, const InTime& in_time, double area,
                                 int length, double drho)
    : patch_(patch),
      target_(flow),
      in_time_(in_time),
      area_(area),
      time_(time(length)),
      start_(drho / 3.0),
      integral_(start_),
      pressure_(start_) {}

double PressureControl::time(int length) {
  return kCrossings * length / kSound;
}

void PressureControl::adjust(std::int64_t step, double mass_in) {
  const double goal = wanted(step) / area_;
  flow_ = step == 0 ? 0.0 : (mass_in - mass_in_) / static_cast<double>(kEvery);
  mass_in_ = mass_in;
  const double lack = goal - flow_ / area_;
  const double full = std::abs(target_) / area_;
  const double resistance = full > 0.0 ? std::abs(integral_ - start_) / full : 0.0;
  const double a_look = static_cast<double>(kEvery) / time_;
  integral_ += std::min((kImpedance + resistance) * a_look, kFastest * kImpedance) * lack;
  pressure_ = integral_ + kImpedance * lack;
}

Record PressureControl::save() const {
  Record record;
  record.set("integral", integral_);
  record.set("pressure", pressure_);
  record.set("mass_in", mass_in_);
  record.set("flow", flow_);
  return record;
}

void PressureControl::load(const Record& record) {
  integral_ = record.real("integral");
  pressure_ = record.real("pressure");
  mass_in_ = record.real("mass_in");
  flow_ = record.real("flow");
}

}  // namespace lbm
