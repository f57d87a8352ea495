// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/collision/collision_operator.h"

#include <ostream>
#include <stdexcept>

namespace lbm {

std::vector<CollisionOperator> known_collisions() {
  return {CollisionOperator::Bgk, CollisionOperator::Trt, CollisionOperator::CentralMoment,
          CollisionOperator::RecursiveRegularised};
}

std::string name_of(CollisionOperator collision) {
  switch (collision) {
    case CollisionOperator::Bgk:
      return "bgk";
    case CollisionOperator::Trt:
      return "trt";
    case CollisionOperator::CentralMoment:
      return "central_moment";
    case CollisionOperator::RecursiveRegularised:
      return "recursive_regularised";
  }
  return "";
}

CollisionOperator collision_operator(const std::string& name) {
  std::string known;
  for (const CollisionOperator collision : known_collisions()) {
    if (name_of(collision) == name) return collision;
    known += " " + name_of(collision);
  }
  throw std::invalid_argument("no collision '" + name + "'; known:" + known);
}

std::ostream& operator<<(std::ostream& out, CollisionOperator collision) {
  return out << name_of(collision);
}

}  // namespace lbm
