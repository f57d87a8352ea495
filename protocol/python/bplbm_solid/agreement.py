# SPDX-License-Identifier: MIT
"""The comparison of the two handshakes: every disagreement, in one sentence each."""

from typing import List

from .frames import CHECKPOINTS, FLUID, SOLID, Handshake

TOLERANCE = 1e-9  # lengths and times may have gone through decimal text
SLACK = 1e-6      # of radius and density ranges
BUOYANCY = {0: "added by the fluid", 1: "added by the solid", 2: "not modelled"}
SCHEDULE = {0: "serial", 1: "overlapped"}


def _same(a: float, b: float, scale: float, tolerance: float = TOLERANCE) -> bool:
    return abs(a - b) <= tolerance * scale


def _geometry(f: Handshake, s: Handshake) -> List[str]:
    found = []
    if f.dimension != s.dimension:
        found.append(f"dimension: fluid {f.dimension}, solid {s.dimension}")
    for k, axis in enumerate("xyz"[:f.dimension]):
        length = f.box_hi[k] - f.box_lo[k]
        if not (_same(f.box_lo[k], s.box_lo[k], length) and _same(f.box_hi[k], s.box_hi[k], length)):
            found.append(f"box {axis}: fluid {f.box_lo[k]:.9g} … {f.box_hi[k]:.9g} m, "
                         f"solid {s.box_lo[k]:.9g} … {s.box_hi[k]:.9g} m")
        if bool(f.periodic[k]) != bool(s.periodic[k]):
            kinds = ["not periodic", "periodic"]
            found.append(f"boundary {axis}: fluid {kinds[bool(f.periodic[k])]}, solid {kinds[bool(s.periodic[k])]}")
    if f.dimension == 2 and not _same(f.depth, s.depth, f.depth):
        found.append(f"depth: fluid {f.depth:.9g} m, solid {s.depth:.9g} m")
    return found


def _forces(f: Handshake, s: Handshake) -> List[str]:
    found = []
    g = max(1e-300, sum(c * c for c in f.gravity) ** 0.5)
    if not all(_same(a, b, g) for a, b in zip(f.gravity, s.gravity)):
        both = ["({:.9g}, {:.9g}, {:.9g}) m/s²".format(*h.gravity) for h in (f, s)]
        found.append(f"gravity: fluid {both[0]}, solid {both[1]}")
    if f.buoyancy != s.buoyancy:
        found.append(f"buoyancy: fluid says '{BUOYANCY.get(f.buoyancy)}', solid says '{BUOYANCY.get(s.buoyancy)}'")
    return found


def _time(f: Handshake, s: Handshake) -> List[str]:
    found = []
    fluid, solid = f.step * f.fluid_steps, s.step * s.solid_steps
    if f.solid_steps != s.solid_steps:
        found.append(f"substeps: fluid's scene says {f.solid_steps} solid steps an interval, solid makes {s.solid_steps}")
    if not _same(fluid, solid, fluid):
        found.append(f"coupling interval: fluid {fluid:.9g} s, solid {solid:.9g} s ({s.solid_steps} × {s.step:.9g} s)")
    if f.first_interval != s.first_interval:
        found.append(f"first coupling interval: fluid {f.first_interval}, solid {s.first_interval}")
    return found


def _particles(f: Handshake, s: Handshake) -> List[str]:
    found = []
    if None not in (f.particles, s.particles) and f.particles != s.particles:
        found.append(f"particles: fluid's scene expects {f.particles}, solid has {s.particles}")
    if s.particles == 0:
        return found
    for what, unit, fluid, solid in (("radius", "m", f.radius, s.radius), ("density", "kg/m³", f.density, s.density)):
        if fluid is None or solid is None:
            continue
        slack = SLACK * fluid[1]
        if solid[0] < fluid[0] - slack or solid[1] > fluid[1] + slack:
            found.append(f"particle {what}: fluid's scene says {fluid[0]:.9g} … {fluid[1]:.9g} {unit}, solid has "
                         f"{solid[0]:.9g} … {solid[1]:.9g} {unit}")
    return found


def disagreements(f: Handshake, s: Handshake) -> List[str]:
    """@param f, s  what the fluid and the solid say"""
    found = []
    if (f.role, s.role) != (FLUID, SOLID):
        found.append(f"roles: '{f.program}' and '{s.program}' are not one fluid and one solid program")
    if f.units != s.units:
        found.append(f"units: fluid {f.units}, solid {s.units}")
    if f.schedule != s.schedule:
        found.append(f"coupling schedule: fluid {SCHEDULE.get(f.schedule)}, solid {SCHEDULE.get(s.schedule)}")
    lacking = f.features & ~s.features
    if lacking & CHECKPOINTS:
        found.append(f"checkpoints: the fluid's scene wants them (run.checkpoint_every), '{s.program}' cannot write any")
    if lacking & ~CHECKPOINTS:
        found.append(f"protocol features: fluid {f.features:#x}, solid {s.features:#x}")
    return found + _geometry(f, s) + _forces(f, s) + _time(f, s) + _particles(f, s)
