// SPDX-License-Identifier: GPL-2.0-or-later
/// `step_report [--collision C] [--scheme S] [--solid-term T] [--weight W]`: hard cases that show
/// in single steps of the fluid, not in what a run writes. Choices are those of a scene's
/// [numerics], also "auto". Prints a JSON object, a value a case, null where the state is not
/// finite any more; tools/report judges them.
///
/// momentum   what a step of two moving discs leaves of fluid + solid − impulses, largest
/// shared     the same of three discs that touch in one cell
/// order      of those three in each of their six orders: largest difference of loads
/// inserted   largest rest of momentum with discs that come late, up to the first that goes
/// late       way of a disc that comes 50 steps late, against one that was there, largest
/// removed    largest rest of momentum while they go, one after the other, and after that
/// none       populations without any disc, against those of a fluid without solids, largest
/// map        solid fractions around a disc that lies on a side, edge or corner of the box, against
///            those around one in the middle, largest difference; both on multiples of 2⁻¹⁰ cells
/// loads      loads on it in each of twenty steps, in the same way
/// face       way of a disc whose centre begins exactly on a side, edge or corner of the box,
///            against one in the middle, 1000 steps, largest
/// collision  what "auto" takes
/// drift      drag on an array carried at 0.02, 0.05 and 0.1 cells a step, over that at rest, − 1
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "lbm_solver/solver/plan.h"
#include "protocol/program/command_line.h"
#include "tests/support/free_disc.h"
#include "tests/support/scheme_fluid.h"

namespace {

using namespace lbm;

/// A periodic box of n × m cells of 1 m with free discs, steps of 1 s, as a scene would be.
Scene scene_of(const NumericsScene& numerics, int n, int m, double tau) {
  Scene scene;
  scene.file = "step_report";
  scene.box.size = {static_cast<double>(n), static_cast<double>(m)};
  scene.box.sides = {SideKind::Periodic, SideKind::Periodic, SideKind::Wall};
  scene.fluid = {.density = 1.0, .viscosity = (tau - 0.5) / 3.0, .velocity_scale = 0.05};
  scene.numerics = numerics;
  scene.numerics.cell = 1.0;
  scene.numerics.time_step = 1.0;
  scene.particles.emplace();
  scene.particles->diameter = {10.0, 10.0};
  scene.particles->density = {2.5, 2.5};
  scene.coupling.emplace();
  scene.end_time = 1e4;
  return scene;
}

/// Eddies of 0.02 cells a step.
void stir(Fluid& fluid) {
  const Domain& d = fluid.domain();
  const double k = 2.0 * std::numbers::pi;
  for (int y = 0; y < d.ny; ++y)
    for (int x = 0; x < d.nx; ++x)
      fluid.set_equilibrium(
          x, y, 1.0,
          {0.02 * std::sin(k * (y + 0.5) / d.ny), 0.02 * std::sin(k * (x + 0.5) / d.nx)});
}

/// The larger one, and from then on what is not finite.
void keep_largest(double& largest, double value) {
  if (!std::isnan(largest) && !(value <= largest)) largest = value;
}

double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const Vec3& apart) {
  double largest = 0.0;
  for (std::size_t s = 0; s < std::min(a.size(), b.size()); ++s)
    keep_largest(largest, (a[s] - b[s] - apart).norm());
  return largest;
}

const Vec3 kNearTheMiddle(24.0 + 77.0 / 1024, 22.0 + 301.0 / 1024);
const std::vector<Vec3> kToTheSides{{-24.0, 0.0}, {24.0, 0.0},    {0.0, -22.0},
                                    {0.0, 22.0},  {-24.0, -22.0}, {24.0, 22.0}};

class Cases {
 public:
  explicit Cases(const NumericsScene& numerics) : numerics_(numerics) {}

  std::string collision() const {
    return name_of(make_plan(scene_of(numerics_, 48, 44, 0.7)).kernel.collision);
  }

  double momentum() const { return largest_rest(two_discs(), 200); }
  double shared() const { return largest_rest(three_discs(), 20); }

  double order() const {
    const Scene scene = scene_of(numerics_, 48, 44, 0.7);
    const Plan plan = make_plan(scene);
    std::vector<int> numbers{0, 1, 2};
    std::vector<BodyLoad> first;
    double largest = 0.0;
    do {
      Fluid fluid = make_fluid(scene, plan);
      const auto all = three_discs();
      std::vector<Body> discs;
      for (const int i : numbers) discs.push_back(all[i]);
      for (int step = 0; step < 20; ++step) {
        fluid.place(discs);
        fluid.step();
        test::move(discs);
      }
      std::vector<BodyLoad> loads(3);
      for (int k = 0; k < 3; ++k) loads[numbers[k]] = fluid.loads()[k];
      if (first.empty()) first = loads;
      for (int i = 0; i < 3; ++i) {
        keep_largest(largest, (loads[i].force - first[i].force).norm());
        keep_largest(largest, (loads[i].torque - first[i].torque).norm());
      }
    } while (std::next_permutation(numbers.begin(), numbers.end()));
    return largest;
  }

  double inserted() const { return come_and_go(0, 30); }
  double removed() const { return come_and_go(30, 70); }

  double late() const {
    const test::FreeRun there = fall({24.0, 22.0}, 0, 250), late = fall({24.0, 22.0}, 50, 300);
    return largest_distance(late.place, there.place, Vec3());
  }

  double face() const {
    const Vec3 inside(24.0, 22.0);
    const test::FreeRun reference = fall(inside, 0, 1000);
    double largest = 0.0;
    for (const Vec3& shift : kToTheSides)
      keep_largest(largest,
                   largest_distance(fall(inside + shift, 0, 1000).place, reference.place, shift));
    return largest;
  }

  double map() const {
    double largest = 0.0;
    const Fluid reference = around(kNearTheMiddle, 1);
    for (const Vec3& shift : kToTheSides) {
      const Fluid fluid = around(kNearTheMiddle + shift, 1);
      for (int y = 0; y < 44; ++y)
        for (int x = 0; x < 48; ++x) {
          const auto sx = static_cast<int>(x + shift.x() + 48) % 48;
          const auto sy = static_cast<int>(y + shift.y() + 44) % 44;
          keep_largest(largest,
                       std::abs(fluid.solid_fraction(sx, sy) - reference.solid_fraction(x, y)));
        }
    }
    return largest;
  }

  double loads() const {
    double largest = 0.0;
    for (int steps = 1; steps <= 20; ++steps) {
      const BodyLoad reference = around(kNearTheMiddle, steps).loads()[0];
      for (const Vec3& shift : kToTheSides) {
        const BodyLoad load = around(kNearTheMiddle + shift, steps).loads()[0];
        keep_largest(largest, (load.force - reference.force).norm());
        keep_largest(largest, (load.torque - reference.torque).norm());
      }
    }
    return largest;
  }

  double none() const {
    Scene scene = scene_of(numerics_, 48, 44, 0.7);
    const Plan plan = make_plan(scene);
    Fluid with = make_fluid(scene, plan);
    scene.numerics.magic = plan.kernel.parameters.magic;  // the choice for solids, without any
    scene.coupling.reset();
    scene.particles.reset();
    scene.numerics.scheme.reset();
    scene.numerics.solid_term.reset();
    Fluid without = make_fluid(scene, make_plan(scene));
    stir(with);
    stir(without);
    for (int step = 0; step < 50; ++step) {
      with.place({});
      with.step();
      without.step();
    }
    double largest = 0.0;
    for (int y = 0; y < with.domain().ny; ++y)
      for (int x = 0; x < with.domain().nx; ++x)
        for (int q = 0; q < D2Q9::Q; ++q)
          keep_largest(largest, std::abs(std::as_const(with).arriving(q, x, y) -
                                         std::as_const(without).arriving(q, x, y)));
    return largest;
  }

  std::vector<double> drift() const {
    std::vector<double> result;
    const double still = array_drag(0.0);
    for (const double carried : {0.02, 0.05, 0.1})
      result.push_back(array_drag(carried) / still - 1.0);
    return result;
  }

 private:
  double largest_rest(std::vector<Body> discs, int steps) const {
    const Scene scene = scene_of(numerics_, 48, 44, 0.7);
    const Plan plan = make_plan(scene);
    Fluid fluid = make_fluid(scene, plan);
    test::MomentumBalance balance(fluid, plan.scheme);
    double largest = 0.0;
    for (int step = 0; step < steps; ++step) {
      keep_largest(largest, balance.step(discs));
      test::move(discs);
    }
    return largest;
  }

  /// Far from each other; one goes through a corner of the box.
  static std::vector<Body> two_discs() {
    return {{1, {3.2, 41.1}, 6.0, {-0.03, 0.04}, 0.002}, {2, {26.0, 20.0}, 5.0, {0.02, 0.01}, 0.0}};
  }

  /// They touch, and the gap between them lies in the middle of a cell.
  static std::vector<Body> three_discs() {
    const Vec3 middle(24.5, 22.5);
    const double radius = 5.0, far = 2.0 * radius / std::numbers::sqrt3;
    std::vector<Body> discs;
    for (int i = 0; i < 3; ++i) {
      const double angle = 0.4 + 2.0 * std::numbers::pi * i / 3.0;
      discs.push_back({i + 1, middle + Vec3(far * std::cos(angle), far * std::sin(angle)), radius,
                       Vec3(0.02 - 0.015 * i, 0.01 * i - 0.01), 0.001 * i});
    }
    return discs;
  }

  /// Largest rest of momentum in steps [from, to) where a disc comes before step 10, another
  /// before step 20, and they go before steps 30 and 50.
  double come_and_go(int from, int to) const {
    const Scene scene = scene_of(numerics_, 48, 44, 0.7);
    const Plan plan = make_plan(scene);
    Fluid fluid = make_fluid(scene, plan);
    stir(fluid);
    test::MomentumBalance balance(fluid, plan.scheme);
    auto discs = two_discs();
    double largest = 0.0;
    for (int step = 0; step < to; ++step) {
      std::vector<Body> there;
      if (step >= 10 && step < 30) there.push_back(discs[0]);
      if (step >= 20 && step < 50) there.push_back(discs[1]);
      const double rest = balance.step(there);
      if (step >= from) keep_largest(largest, rest);
      test::move(discs);
    }
    return largest;
  }

  /// A fluid after some steps of a disc that moves through it.
  Fluid around(const Vec3& start, int steps) const {
    const Scene scene = scene_of(numerics_, 48, 44, 0.7);
    Fluid fluid = make_fluid(scene, make_plan(scene));
    std::vector<Body> disc{{1, start, 5.0, {0.0625, -0.03125}, 0.002}};
    for (int step = 0; step < steps; ++step) {
      fluid.place(disc);
      fluid.step();
      test::move(disc);
    }
    return fluid;
  }

  /// A disc that falls from rest in a fluid at rest.
  test::FreeRun fall(const Vec3& start, int inserted, int steps) const {
    Scene scene = scene_of(numerics_, 48, 44, 0.7);
    scene.fluid.gravity = {2e-5, -1e-5};
    Fluid fluid = make_fluid(scene, make_plan(scene));
    return test::free_run(
        fluid, scene,
        {.ratio = 2.5, .radius = 5.0, .start = start, .inserted = inserted, .steps = steps});
  }

  double array_drag(double carried) const {
    const test::SlowArray array;
    Scene scene = scene_of(numerics_, array.n, array.n, array.tau);
    scene.fluid.body_force = {array.g, 0.0};
    scene.fluid.velocity_scale = 0.1;
    scene.particles->diameter = {9.0, 9.0};
    Fluid fluid = make_fluid(scene, make_plan(scene));
    return array.drag(fluid, carried);
  }

  NumericsScene numerics_;
};

/// An option that takes what a scene takes. @param to  nothing where that is "auto"
template <Choice E>
void add_choice(CLI::App& app, const char* option, std::optional<E>& to) {
  std::vector<std::string> names{"auto"};
  for (const E value : choices<E>()) names.push_back(name_of(value));
  const auto take = [&to](const std::string& name) {
    if (name != "auto") to = from_name<E>(name);
  };
  app.add_option_function<std::string>(option, take, "as in a scene")->check(CLI::IsMember(names));
}

}  // namespace

int main(int argc, char** argv) {
  NumericsScene numerics;
  CLI::App app{"Hard cases that show in single steps of the fluid, with one choice of numerics"};
  add_choice(app, "--collision", numerics.collision);
  add_choice(app, "--scheme", numerics.scheme);
  add_choice(app, "--solid-term", numerics.solid_term);
  add_choice(app, "--weight", numerics.weight);
  if (const auto code = protocol::read_command_line(app, "step_report", argc, argv)) return *code;
  try {
    const Cases cases(numerics);
    const nlohmann::json values{{"collision", cases.collision()},
                                {"momentum", cases.momentum()},
                                {"shared", cases.shared()},
                                {"order", cases.order()},
                                {"inserted", cases.inserted()},
                                {"late", cases.late()},
                                {"removed", cases.removed()},
                                {"none", cases.none()},
                                {"map", cases.map()},
                                {"loads", cases.loads()},
                                {"face", cases.face()},
                                {"drift", cases.drift()}};
    fmt::print("{}\n", values.dump());
    return protocol::kOk;
  } catch (const std::exception& error) {  // InputError, or a name that is not known
    fmt::print(stderr, "step_report | error | {}\n", error.what());
    return protocol::kBadInput;
  }
}
