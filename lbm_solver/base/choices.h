// SPDX-License-Identifier: GPL-2.0-or-later
/// What a scene chooses by name: each choice is an enumeration with its table of names, which scene
/// files, reports, checkpoints and messages share.
#pragma once

#include <algorithm>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace lbm {

/// A value of a choice, and its name.
template <class E>
struct Named {
  E value;
  const char* name;
};

/// The table of a choice, in the order of the enumeration, and its name in a message.
template <class E>
struct ChoiceNames;

/// The velocities of the populations; lattice/lattice.h has the numbers.
enum class VelocitySet { D2Q9, D3Q19, D3Q27 };

template <>
struct ChoiceNames<VelocitySet> {
  static constexpr const char* what = "lattice";
  static constexpr Named<VelocitySet> table[] = {
      {VelocitySet::D2Q9, "D2Q9"}, {VelocitySet::D3Q19, "D3Q19"}, {VelocitySet::D3Q27, "D3Q27"}};
};

/// How the populations of a fluid cell relax; docs/collision.md says what each is good for.
enum class CollisionOperator { Bgk, Trt, CentralMoment, RecursiveRegularised };

template <>
struct ChoiceNames<CollisionOperator> {
  static constexpr const char* what = "collision";
  static constexpr Named<CollisionOperator> table[] = {
      {CollisionOperator::Bgk, "bgk"},
      {CollisionOperator::Trt, "trt"},
      {CollisionOperator::CentralMoment, "central_moment"},
      {CollisionOperator::RecursiveRegularised, "recursive_regularised"}};
};

/// The solid collision operator of covered cells; docs/solids.md has the equations.
enum class SolidTerm {
  None,  ///< there are no covered cells; no scene can choose it
  Resistance,
  LayeredResistance,
  NobleTorczynski,
  Holdych,
  Superposition,
  LayeredHoldych,
  LayeredNobleTorczynski,
};

template <>
struct ChoiceNames<SolidTerm> {
  static constexpr const char* what = "solid term";
  static constexpr Named<SolidTerm> table[] = {
      {SolidTerm::None, "none"},
      {SolidTerm::Resistance, "resistance"},
      {SolidTerm::LayeredResistance, "layered_resistance"},
      {SolidTerm::NobleTorczynski, "noble_torczynski"},
      {SolidTerm::Holdych, "holdych"},
      {SolidTerm::Superposition, "superposition"},
      {SolidTerm::LayeredHoldych, "layered_holdych"},
      {SolidTerm::LayeredNobleTorczynski, "layered_noble_torczynski"}};
};

/// How solids act on the fluid.
enum class SolidScheme {
  ImmersedMovingBoundary,  ///< covered cells of the sweep; the others are each a BodyScheme
  BounceBack,
  InterpolatedBounceBack,
  ImplicitImmersedBoundary,
  SpringImmersedBoundary,
};

template <>
struct ChoiceNames<SolidScheme> {
  static constexpr const char* what = "scheme";
  static constexpr Named<SolidScheme> table[] = {
      {SolidScheme::ImmersedMovingBoundary, "immersed_moving_boundary"},
      {SolidScheme::BounceBack, "bounce_back"},
      {SolidScheme::InterpolatedBounceBack, "interpolated_bounce_back"},
      {SolidScheme::ImplicitImmersedBoundary, "implicit_immersed_boundary"},
      {SolidScheme::SpringImmersedBoundary, "spring_immersed_boundary"}};
};

/// How the weight B of the solid's collision follows from the solid fraction ε of a cell:
///   B = ε s / ((1 - ε) c(s) + s),   s = τ - ½
enum class WeightRule {
  Viscous,   ///< c = 1, paper A Eq 34
  Balanced,  ///< c = 1 - s/2
  Fraction,  ///< c = 0: B = ε
};

template <>
struct ChoiceNames<WeightRule> {
  static constexpr const char* what = "weight";
  static constexpr Named<WeightRule> table[] = {{WeightRule::Viscous, "viscous"},
                                                {WeightRule::Balanced, "balanced"},
                                                {WeightRule::Fraction, "fraction"}};
};

/// Type in which populations are stored. Sums of forces and masses are double in both.
enum class Precision { Double, Single };

template <>
struct ChoiceNames<Precision> {
  static constexpr const char* what = "precision";
  static constexpr Named<Precision> table[] = {{Precision::Double, "double"},
                                               {Precision::Single, "single"}};
};

/// How an eddy viscosity depends on the place.
enum class EddyModel { Smagorinsky, Wale };

template <>
struct ChoiceNames<EddyModel> {
  static constexpr const char* what = "eddy viscosity";
  static constexpr Named<EddyModel> table[] = {{EddyModel::Smagorinsky, "smagorinsky"},
                                               {EddyModel::Wale, "wale"}};
};

template <class E>
concept Choice = requires {
  ChoiceNames<E>::table;
};

/// As a scene and a report write it, e.g. "central_moment".
template <Choice E>
std::string name_of(E value) {
  return std::ranges::find(ChoiceNames<E>::table, value, &Named<E>::value)->name;
}

/// All values that a scene can choose, in the order of the enumeration.
template <Choice E>
std::vector<E> choices() {
  std::vector<E> all;
  for (const auto& [value, name] : ChoiceNames<E>::table) {
    if constexpr (requires { E::None; })
      if (value == E::None) continue;
    all.push_back(value);
  }
  return all;
}

/// The names of some values, also of other enumerations that have a name_of.
template <class E>
std::vector<std::string> names_of(const std::vector<E>& values) {
  std::vector<std::string> names;
  for (const E value : values) names.push_back(name_of(value));
  return names;
}

/// @throws std::invalid_argument naming the known ones
template <Choice E>
E from_name(const std::string& name) {
  std::string known;
  for (const E value : choices<E>()) {
    if (name_of(value) == name) return value;
    known += " " + name_of(value);
  }
  throw std::invalid_argument(std::string("no ") + ChoiceNames<E>::what + " '" + name +
                              "'; known:" + known);
}

template <Choice E>
std::ostream& operator<<(std::ostream& out, E value) {
  return out << name_of(value);
}

}  // namespace lbm
