// SPDX-License-Identifier: GPL-2.0-or-later
/// `mapping_benchmark [SPHERES…]` (100 000 and 1 000 000): what many spheres of six cells cost
/// beside the lattice, on one core: placing all anew, placing them where they are, their loads, and
/// memory. They lie on a cubic lattice of eight cells and fill 0.22 of the box, as in a packing of
/// many rows.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <ctime>

#include "lbm_solver/immersed/cover_map.h"

namespace {

using namespace lbm;

constexpr double kRadius = 3.0;
constexpr int kPitch = 8;

/// Seconds of the processor, which other work on the machine does not lengthen much.
double now() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void measure(std::int64_t spheres) {
  const int side = static_cast<int>(std::ceil(std::cbrt(static_cast<double>(spheres)) - 1e-9));
  const int n = side * kPitch;
  const Domain domain{n, n, Side::Periodic, Side::Periodic, n, Side::Periodic};
  std::vector<Body> bodies;
  for (std::int64_t i = 0; i < spheres; ++i) {
    const double golden = std::fmod(0.618 * static_cast<double>(i), 1.0);  // each in its own cells
    const Vec3 site(static_cast<double>(i % side), static_cast<double>(i / side % side),
                    static_cast<double>(i / side / side));
    bodies.push_back({i + 1,
                      kPitch * site + Vec3(4.0 + golden, 4.0 - 0.7 * golden, 4.0 + 0.4 * golden),
                      kRadius,
                      {0.01, 0.0, 0.0},
                      Spin()});
  }
  CoverMap map(domain);
  double begin = now();
  map.update(bodies);
  const double first = now() - begin;
  for (Body& b : bodies) b.centre.x() += 0.3;
  begin = now();
  map.update(bodies);
  const double anew = now() - begin;
  begin = now();
  map.update(bodies);
  const double same = now() - begin;
  begin = now();
  const auto loads = map.loads();
  const double summed = now() - begin;
  const double each = 1e9 / static_cast<double>(loads.size()), cells = std::pow(n, 3);
  fmt::print(
      "{:>8} spheres in {}³ cells: placed first {:.2f} s; anew {:.3f} s ({:.0f} ns each); where "
      "they are {:.3f} s ({:.0f} ns); loads {:.3f} s ({:.0f} ns); {:.0f} MB, {:.2f} kB each, "
      "{:.1f} B a cell\n",
      loads.size(), n, first, anew, anew * each, same, same * each, summed, summed * each,
      1e-6 * static_cast<double>(map.bytes()),
      1e-3 * static_cast<double>(map.bytes()) * 1e-9 * each,
      static_cast<double>(map.bytes()) / cells);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    measure(100000);
    measure(1000000);
  }
  for (int i = 1; i < argc; ++i) {
    const long long spheres = std::atoll(argv[i]);
    if (spheres < 1) {
      fmt::print(stderr, "mapping_benchmark | error | '{}': give numbers of spheres\n", argv[i]);
      return 2;
    }
    measure(spheres);
  }
  return 0;
}
