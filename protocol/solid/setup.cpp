// SPDX-License-Identifier: MIT
#include "protocol/solid/setup.h"

#include <algorithm>
#include <optional>

namespace protocol {

bplbm_setup setup_of(const Hello& fluid) {
  bplbm_setup setup{};
  setup.dimension = static_cast<std::int32_t>(fluid.dimension);
  std::copy(fluid.periodic.begin(), fluid.periodic.end(), setup.periodic);
  std::copy(fluid.box_lo.begin(), fluid.box_lo.end(), setup.box_low);
  std::copy(fluid.box_hi.begin(), fluid.box_hi.end(), setup.box_high);
  std::copy(fluid.gravity.begin(), fluid.gravity.end(), setup.gravity);
  setup.depth = fluid.depth;
  setup.buoyancy = static_cast<std::int32_t>(fluid.buoyancy);
  setup.schedule = static_cast<std::int32_t>(fluid.schedule);
  setup.step = fluid.step * fluid.fluid_steps / fluid.solid_steps;
  setup.steps = static_cast<std::int32_t>(fluid.solid_steps);
  setup.checkpoints = fluid.features & kCheckpoints ? 1 : 0;
  setup.first_interval = fluid.first_interval;
  setup.particles = fluid.particles.value_or(-1);
  const auto range = [](const std::optional<Range>& from, double* to) {
    if (from) to[0] = from->lo, to[1] = from->hi;
  };
  range(fluid.radius, setup.radius);
  range(fluid.density, setup.density);
  for (std::size_t side = 0; side < 6; ++side)
    setup.sides[side] = fluid.sides ? static_cast<std::int32_t>((*fluid.sides)[side]) : -1;
  return setup;
}

Hello hello_of(const bplbm_setup& setup) {
  Hello hello;
  hello.role = Role::Solid;
  hello.dimension = static_cast<std::uint32_t>(setup.dimension);
  for (std::size_t k = 0; k < 3; ++k) hello.periodic[k] = setup.periodic[k] != 0;
  std::copy_n(setup.box_low, 3, hello.box_lo.begin());
  std::copy_n(setup.box_high, 3, hello.box_hi.begin());
  std::copy_n(setup.gravity, 3, hello.gravity.begin());
  hello.depth = setup.depth;
  hello.buoyancy = static_cast<Buoyancy>(setup.buoyancy);
  hello.schedule = static_cast<Schedule>(setup.schedule);
  hello.step = setup.step;
  hello.solid_steps = static_cast<std::uint32_t>(setup.steps);
  if (setup.checkpoints) hello.features = kCheckpoints;
  hello.first_interval = setup.first_interval;
  if (setup.particles >= 0) hello.particles = setup.particles;
  if (setup.radius[1] > 0.0) hello.radius = {setup.radius[0], setup.radius[1]};
  if (setup.density[1] > 0.0) hello.density = {setup.density[0], setup.density[1]};
  if (std::all_of(setup.sides, setup.sides + 6, [](std::int32_t side) { return side >= 0; })) {
    hello.sides.emplace();
    for (std::size_t side = 0; side < 6; ++side)
      (*hello.sides)[side] = static_cast<SideWall>(setup.sides[side]);
  }
  return hello;
}

}  // namespace protocol
