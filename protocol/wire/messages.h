// SPDX-License-Identifier: MIT
/// What the two programs say to each other: plain data, SI units, no behaviour.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace protocol {

inline constexpr std::uint32_t kProtocolVersion = 4;

using Vec3 = std::array<double, 3>;

enum class Role : std::uint32_t { Fluid = 1, Solid = 2 };

/// The side that adds the buoyant force -rho_f V g to a particle. Exactly one may.
enum class Buoyancy : std::uint32_t { ByFluid = 0, BySolid = 1, None = 2 };

/// Serial: the fluid advances an interval, then the solid, in turn. Overlapped: both at once, the
/// solid with the loads of the interval before (its own in the first).
enum class Schedule : std::uint32_t { Serial = 0, Overlapped = 1 };

/// What a solid can do beyond the minimum, and what the fluid's scene needs of it.
enum Features : std::uint64_t { kCheckpoints = 1 };

struct Range {
  double lo = 0.0, hi = 0.0;
};

/// A number or text that the scene offers to the solid program's script under a name.
struct Variable {
  std::string name, value;
};

/// What a side of the box is for the one who says so.
enum class SideWall : std::uint8_t { None = 0, Whole = 1, Partly = 2 };
using SideWalls = std::array<SideWall, 6>;  ///< x low, x high, y low, y high, z low, z high

/// The handshake: everything that both sides must agree on before the first step.
struct Hello {
  std::uint32_t version = kProtocolVersion;
  Role role = Role::Fluid;
  std::string program;          ///< e.g. "lbm"
  std::string program_version;  ///< for the log only
  std::uint32_t dimension = 2;
  Vec3 box_lo{}, box_hi{};                 ///< [m]; in 2D z spans the depth
  std::array<std::uint8_t, 3> periodic{};  ///< one flag an axis; z is not compared in 2D
  double depth = 1.0;                      ///< [m], 2D only: forces are those of this depth
  std::string units = "SI";
  Vec3 gravity{};  ///< [m/s^2]
  Buoyancy buoyancy = Buoyancy::ByFluid;
  double step = 0.0;              ///< this side's own time step [s]
  std::uint32_t fluid_steps = 1;  ///< fluid steps a coupling interval
  std::uint32_t solid_steps = 1;  ///< solid steps a coupling interval (substeps)
  std::int64_t first_interval = 0;
  Schedule schedule = Schedule::Serial;
  std::uint64_t features = 0;             ///< solid: what it can do; fluid: what it needs
  std::optional<std::int64_t> particles;  ///< absent: this side does not care
  std::optional<Range> radius;            ///< [m]
  std::optional<Range> density;           ///< mass / (volume, in 2D pi r^2 depth) [kg/m^3]
  Vec3 subdomain_lo{}, subdomain_hi{};    ///< of the sending rank [m]; routes particles
  double reach = 0.0;               ///< fluid: how far beyond a particle's surface it acts [m]
  std::optional<SideWalls> sides;   ///< absent: this side does not say
  std::vector<std::string> bodies;  ///< walls that are no side of the box, a name each
  std::vector<Variable> variables;  ///< fluid only: offered to the solid's script
};

/// The verdict on the partner's handshake. A refusal lists every disagreement.
struct Answer {
  bool accept = true;
  std::vector<std::string> reasons;
};

/// Flags of a step; combined with |.
enum StepFlags : std::uint32_t {
  kContinue = 0,
  kLast = 1,        ///< states only: the final positions; the fluid does not advance any more
  kStop = 2,        ///< loads only: send one more state, flagged kLast, and leave
  kCheckpoint = 4,  ///< loads: write a checkpoint with the next states; states: it is written
  kWantBonds = 8,   ///< loads only: list the bonds with the next states
  /// loads only: before the next states set yourself up as a restart from a checkpoint there would,
  /// whether or not one is written: a run that is stopped there goes on to the bit
  kSettle = 16,
  kStopWished = 32,  ///< states only: the sender was told to end; the fluid ends as if it had been
};

struct StepHeader {
  std::int64_t interval = 0;  ///< coupling interval, counted from 0
  double time = 0.0;          ///< [s]
  std::uint32_t flags = kContinue;
};

/// Motion of one particle at the beginning of an interval.
struct State {
  std::int64_t id = 0;
  Vec3 x{}, v{}, omega{};  ///< [m], [m/s], [rad/s]
};

/// What the solid computes with at the moment. It must remain what was agreed.
struct Setting {
  double step = 0.0;        ///< its own time step [s]
  Vec3 box_lo{}, box_hi{};  ///< [m]
};

inline constexpr std::int64_t kItself = -1;  ///< a sphere that is its own carrier

/// What rarely changes: sent with a particle's first state and whenever it differs.
struct Shape {
  std::int64_t id = 0;
  double radius = 0.0;   ///< [m]
  double mass = 0.0;     ///< [kg], in 2D of the agreed depth
  double inertia = 0.0;  ///< about the centre [kg m^2]
  std::int64_t type = 1;
  std::int64_t epoch =
      0;  ///< another one: the id has passed to another particle, which starts anew
  std::int64_t carrier = kItself;  ///< id of the body that the sphere belongs to
  double volume = 0.0;  ///< that it displaces [m^3], in 2D of the agreed depth; 0: that of its ball
};

struct Particle {
  State state;
  Shape shape;
};

/// Mean hydrodynamic load on one particle over an interval, about its centre.
struct Load {
  std::int64_t id = 0;
  Vec3 force{}, torque{};  ///< [N], [N m]
};

/// A bond between two particles, for pictures.
struct Bond {
  std::int64_t first = 0, second = 0;  ///< ids
  std::int64_t state = 0;              ///< 0 intact, 1 broken by tension, 2 by shear
};

/// What became of a solid's bonds: how many are there now, and since the beginning of the run how
/// many broke by tension and by shear, left the box with a particle, or vanished with one that was
/// taken out.
struct BondCounts {
  std::int64_t intact = 0, tension = 0, shear = 0, left = 0, lost = 0;
};

/// What a solid tells of itself beside its states; counts are of the sending rank.
struct SolidReport {
  std::int64_t grains_left = 0;     ///< through sides that are not periodic, since the beginning
  std::optional<BondCounts> bonds;  ///< nothing where there never were any
  std::vector<Bond> list;           ///< of bonds; empty unless it was asked for
};

struct StateBatch {
  StepHeader head;
  Setting setting;
  std::vector<State> states;
  std::vector<Shape> shapes;
  std::optional<SolidReport> report;  ///< to fluid rank 0 only; not kept in traces
};

struct LoadBatch {
  StepHeader head;
  std::vector<Load> loads;
};

/// A side leaves in good order.
struct Goodbye {
  std::string reason;
};

/// A side cannot go on. Overtakes everything else in flight.
struct Fault {
  std::int32_t exit_code = 1;
  std::string reason;
};

/// "I have read your fault and cleaned up; you need not wait for me."
struct Farewell {};

static_assert(sizeof(State) == 80 && sizeof(Shape) == 64 && sizeof(Load) == 56 &&
                  sizeof(Bond) == 24,
              "records travel as raw memory: no padding");
static_assert(std::is_trivially_copyable_v<State> && std::is_trivially_copyable_v<Shape> &&
              std::is_trivially_copyable_v<Load>);

}  // namespace protocol
