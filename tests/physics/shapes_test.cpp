// SPDX-License-Identifier: GPL-2.0-or-later
/// Meshes and images as solids in a flow: the same drag, flux and walls as the shapes that they
/// draw.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/solver/fluid.h"
#include "tests/support/array_references.h"
#include "tests/support/flux.h"
#include "tests/support/meshes.h"

namespace {

using namespace lbm;
using std::numbers::pi;
using test::flux;

constexpr double kTau = 1.0;

KernelChoice choice(VelocitySet lattice, const Vec3& force) {
  KernelChoice c{.force = force.norm() > 0.0,
                 .solid_term = SolidTerm::Resistance,
                 .parameters = {.tau = kTau,
                                .magic = kResistanceMagic,
                                .force_x = force.x(),
                                .force_y = force.y(),
                                .force_z = force.z()}};
  c.lattice = lattice;
  return c;
}

Geometry of(TriangleMesh mesh, bool hollow = false) {
  return {MeshSolid{std::make_shared<const TriangleMesh>(std::move(mesh)), hollow}};
}

/// Drag F/(μ U) of one solid in a periodic box, by its load and the flux.
struct Drag {
  double drag, load_over_drive, torque;
};
Drag drag(const Domain& box, const Geometry& solid, int steps) {
  const double g = 1e-6, nu = (kTau - 0.5) / 3.0;
  Fluid fluid(box,
              choice(box.dimension() == 2 ? VelocitySet::D2Q9 : VelocitySet::D3Q19, {g, 0.0, 0.0}));
  std::vector<BodyLoad> loads;
  if (const auto* ball = std::get_if<Ball>(&solid.shape)) {
    Body body;
    body.centre = ball->centre;
    body.radius = ball->radius;
    fluid.place({&body, 1});
    fluid.advance(steps);
    loads = fluid.loads();
  } else {
    fluid.add(solid);
    fluid.advance(steps);
    loads = fluid.fixed_loads();
  }
  const double force = loads[0].force.x();
  return {force / (nu * flux(fluid).x()), force / (g * box.nx * box.ny * box.nz),
          loads[0].torque.norm() / force};
}

const Domain kCube{16, 16, Side::Periodic, Side::Periodic, 16, Side::Periodic};

// A tenth of a per cent is left of the polygons and of the chords of the analytic ball.
TEST(Mesh, OfASphereHasTheDragOfTheSphere) {
  const Vec3 centre(8.18, 8.33, 7.89);
  const double r = 4.963;  // ten cells across, c = 0.125
  const Drag ball = drag(kCube, {Ball{centre, r}}, 1500);
  const Drag mesh = drag(kCube, of(test::sphere_mesh(centre, r, 4)), 1500);
  RecordProperty("error", std::to_string(mesh.drag / ball.drag - 1.0));
  std::printf("drag of the mesh over that of the ball - 1 = %.4f %%\n",
              100.0 * (mesh.drag / ball.drag - 1.0));
  EXPECT_NEAR(mesh.drag / ball.drag, 1.0, 0.005);
  EXPECT_NEAR(mesh.load_over_drive, 1.0, 1e-4);
  EXPECT_LT(mesh.torque, 0.05);
}

// Its cells are whole ones: nothing is different, to the bit.
TEST(Mesh, OfABoxOnTheCellsIsABlock) {
  const CellBox block{{5, 4, 6}, {11, 9, 10}};
  const auto run = [&](auto&& add) {
    Fluid fluid(kCube, choice(VelocitySet::D3Q19, {1e-6, 3e-7, 0.0}));
    add(fluid);
    fluid.advance(101);
    std::vector<double> all;
    for (int z = 0; z < 16; ++z)
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
          for (int q = 0; q < 19; ++q) all.push_back(std::as_const(fluid).arriving(q, x, y, z));
    return all;
  };
  const auto of_block = run([&](Fluid& f) { f.add_wall(block.from, block.to); });
  EXPECT_EQ(run([&](Fluid& f) { f.add(of(test::box_mesh({5, 4, 6}, {11, 9, 10}))); }), of_block);
  EXPECT_EQ(run([&](Fluid& f) { f.add({block}); }), of_block);
}

/// Copies of a line along `way` through the middle of a periodic box: where they pass, across the
/// line. The way is that from one corner of the box to another, or to a neighbour along an edge.
std::vector<Vec3> copies_of_line(const Domain& box, const Vec3& way) {
  std::vector<Vec3> across;
  for (int k = -2; k <= 2; ++k)
    for (int j = -2; j <= 2; ++j)
      for (int i = -2; i <= 2; ++i) {
        Vec3 offset(i * box.nx, j * box.ny, k * box.nz);
        offset -= way * (offset.dot(way) / way.squaredNorm());
        const auto same = [&](const Vec3& o) { return (o - offset).norm() < 1e-9; };
        if (std::ranges::none_of(across, same)) across.push_back(offset);
      }
  return across;
}

/// A pipe of sixteen cells that a periodic box repeats without an end, where it goes from one
/// corner to another: so a body force may drive the fluid along it, at any angle. Flux along it
/// over that of Hagen and Poiseuille, π R⁴ g / 8ν.
double pipe_flux(const Domain& box, const Vec3& way) {
  const double r = 8.0, g = 1e-6, nu = (kTau - 0.5) / 3.0;
  const Vec3 along = way.normalized();
  const Vec3 middle(0.5 * box.nx + 0.21, 0.5 * box.ny + 0.37, 0.5 * box.nz + 0.13);
  std::vector<TriangleMesh> pipes;
  for (const Vec3& offset : copies_of_line(box, way)) {
    EXPECT_TRUE(offset.norm() < 1e-9 || offset.norm() > 2.0 * r + 2.0);
    const Vec3 place = middle + offset;
    pipes.push_back(test::cylinder_mesh(place - 400.0 * along, place + 400.0 * along, r, 128));
  }
  Fluid fluid(box, choice(VelocitySet::D3Q19, g * along));
  fluid.add(of(test::together(pipes), true));
  fluid.advance(800);  // twelve times the slowest decay, R²/5.8ν
  const double mean =
      pi * std::pow(r, 4) * g / (8.0 * nu) * way.norm() / (box.nx * box.ny * box.nz);
  return flux(fluid).dot(along) / mean;
}

// Angles from the x axis towards the y axis, and towards the diagonal between y and z: to half a
// degree, as whole numbers of cells give them.
TEST(Mesh, OfAPipeHasTheFluxOfHagenAndPoiseuilleAtEveryAngle) {
  const Side p = Side::Periodic;
  const Cell3 boxes[] = {{4, 20, 20},   {78, 21, 20}, {42, 24, 20}, {28, 28, 20},
                         {116, 22, 22}, {59, 24, 24}, {37, 26, 26}};
  for (const Cell3& n : boxes) {
    const bool straight = n[0] == 4, diagonal = n[1] == n[2] && !straight;
    const Vec3 way(n[0], straight ? 0 : n[1], diagonal ? n[2] : 0);
    const double ratio = pipe_flux({n[0], n[1], p, p, n[2], p}, way);
    std::printf("pipe at %4.1f degrees towards %s: flux %+.3f %%\n",
                std::acos(way.normalized().x()) * 180.0 / pi, diagonal ? "(0, 1, 1)" : "(0, 1, 0)",
                100.0 * (ratio - 1.0));
    EXPECT_NEAR(ratio, 1.0, 0.01) << n[0] << ' ' << n[1] << ' ' << n[2];
  }
}

// Inside of a plate, at an angle, lie whole cells that reflect all that arrives: the fluid on one
// side neither gains nor loses any mass. (Five cells thick, so that what a reflecting cell holds
// for a step is still on its own side of the middle.)
TEST(Mesh, LetsNothingThrough) {
  const Domain box{30, 12, Side::Wall, Side::Periodic, 10, Side::Wall};
  const double angle = 0.4;
  const TriangleMesh plate =
      test::turned(test::box_mesh({12.5, -30, -30}, {17.5, 30, 30}), {15, 6, 5}, {0, 1, 0}, angle);
  Fluid fluid(box, choice(VelocitySet::D3Q19, {}));
  fluid.add(of(plate));
  const auto each_left_cell = [&](auto&& f) {
    for (int z = 0; z < box.nz; ++z)
      for (int y = 0; y < box.ny; ++y)
        for (int x = 0; x < box.nx; ++x)
          if (std::cos(angle) * (x + 0.5 - 15.0) < std::sin(angle) * (z + 0.5 - 5.0)) f(x, y, z);
  };
  each_left_cell([&](int x, int y, int z) {
    if (fluid.solid_fraction(x, y, z) < 1.0)
      fluid.set_equilibrium({x, y, z}, 1.05, Vec3(0.01, 0.01, 0.0));
  });
  const auto left = [&] {
    double mass = 0.0;
    each_left_cell([&](int x, int y, int z) { mass += fluid.cell(x, y, z).rho - 1.0; });
    return mass;
  };
  const double before = left();
  ASSERT_GT(before, 10.0);
  fluid.advance(2000);
  EXPECT_LT(std::abs(left() - before), 1e-12 * 15 * 12 * 10);  // of the mass on that side
}

/// A disc as an image: its solid fractions as grey levels, or cut at a half.
Geometry drawn(const Ball& disc, const Domain& box, bool cut) {
  auto image = std::make_shared<Voxels>();
  image->size = {box.nx, box.ny, 1};
  image->solid.assign(static_cast<std::size_t>(box.nx) * box.ny, 0.0F);
  fill({disc}, box, Block::whole(box), {}, [&](const FractionSpan& span) {
    for (std::size_t k = 0; k < span.fractions.size(); ++k) {
      const double eps = span.fractions[k];
      image->solid[image->index(span.x + static_cast<int>(k), span.y, 0)] =
          static_cast<float>(cut ? std::round(eps) : eps);
    }
  });
  return {VoxelSolid{image, {}, 1, 1}};
}

// A disc drawn in grey is the disc, wherever it lies in the cells (0.3 % are the shift of curved
// surfaces, which an image does not get); a staircase is another body at every place.
TEST(Image, OfADiscHasItsDragInGrey) {
  const Domain box{20, 20, Side::Periodic, Side::Periodic};
  double worst = 0.0;
  for (const Vec3& place : test::kPlacesInACell) {
    const Ball disc{{10.0 + place.x(), 10.0 + place.y()}, 5.046};  // ten cells across, c = 0.2
    const double exact = drag(box, {disc}, 2000).drag;
    const double grey = drag(box, drawn(disc, box, false), 2000).drag / exact - 1.0;
    const double stairs = drag(box, drawn(disc, box, true), 2000).drag / exact - 1.0;
    std::printf("disc as an image: grey %+.3f %%, staircase %+.2f %%\n", 100.0 * grey,
                100.0 * stairs);
    EXPECT_LT(std::abs(grey), 0.005);
    worst = std::max(worst, std::abs(stairs));
  }
  EXPECT_GT(worst, 0.02);
}

// A packing drawn as an image takes the memory of its spheres: populations of the box, and blocks
// where it covers cells. (A block holds eight cells with 128 bytes, spheres besides one of their
// own where two meet in a block.)
TEST(Image, OfAPackingTakesTheMemoryOfItsSpheres) {
  constexpr int n = 64, along = 4;
  const Domain box{n, n, Side::Periodic, Side::Periodic, n, Side::Periodic};
  auto image = std::make_shared<Voxels>();
  image->size = {n, n, n};
  image->solid.assign(static_cast<std::size_t>(n) * n * n, 0.0F);
  std::vector<Body> spheres;
  for (int k = 0; k < along * along * along; ++k) {
    Body& body = spheres.emplace_back();
    body.id = k + 1;
    body.radius = 7.7;
    body.centre = {16.0 * (k % along) + 8.3, 16.0 * (k / along % along) + 8.1,
                   16.0 * (k / along / along) + 7.8};
    fill({Ball{body.centre, body.radius}}, box, Block::whole(box), {},
         [&](const FractionSpan& span) {
           for (std::size_t i = 0; i < span.fractions.size(); ++i)
             image->solid[image->index(span.x + static_cast<int>(i), span.y, span.z)] +=
                 static_cast<float>(span.fractions[i]);
         });
  }
  Fluid drawn(box, choice(VelocitySet::D3Q19, {})), placed(box, choice(VelocitySet::D3Q19, {}));
  drawn.add({VoxelSolid{image, {}, 1, 1}});
  placed.place(spheres);
  auto as_image = drawn.bytes(), as_spheres = placed.bytes();
  std::printf("64 spheres in 64³ cells: %.1f MB of solids as an image, %.1f MB as spheres\n",
              1e-6 * as_image["solids"], 1e-6 * as_spheres["solids"]);
  EXPECT_EQ(as_image["populations"], as_spheres["populations"]);
  EXPECT_LT(as_image["solids"], 1.1 * as_spheres["solids"]);
  EXPECT_GT(as_image["solids"], 0.5 * as_spheres["solids"]);
}

// A run that goes on from a record has the loads of the one that did not stop, to the bit.
TEST(Mesh, KeepsItsLoadsOverARestart) {
  const Geometry ball = of(test::sphere_mesh({8.1, 8.2, 7.9}, 5.0, 3));
  const auto fresh = [&] {
    Fluid fluid(kCube, choice(VelocitySet::D3Q19, {1e-6, 0.0, 0.0}));
    fluid.add(ball);
    return fluid;
  };
  Fluid whole = fresh(), first = fresh(), second = fresh();
  whole.advance(20);
  first.advance(10);
  second.load(first.save());
  second.advance(10);
  EXPECT_EQ(whole.fixed_loads()[0].force, second.fixed_loads()[0].force);
  EXPECT_EQ(whole.fixed_loads()[0].torque, second.fixed_loads()[0].torque);
  EXPECT_GT(whole.fixed_loads()[0].force.x(), 0.0);
}

}  // namespace
