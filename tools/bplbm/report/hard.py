"""The hard cases: what is run, and what is asked of it."""

from collections.abc import Callable
from dataclasses import dataclass

from bplbm.project import ROOT
from bplbm.report.cases import array_run, step_of
from bplbm.report.judges import (alike, at_most, breaks_alike, burst, carried, channel, drift, flat, gel_flow, held, jump, noise,
                           noises, order, overshoot, rest, rises, same_way, street, told, warned)
from bplbm.report.runs import merged

OWN = ROOT / "tests" / "hard"  # scenes that are hard cases and nothing else


@dataclass
class Hard:
    """A row: what is asked of runs that differ by an overlay, all of which must come to their end."""

    name: str
    asked: str
    scene: str  # of cases/, or the path of another folder
    runs: list  # overlays
    judge: Callable = lambda runs: (True, "")  # of the runs -> whether it is met, value; None: told, not judged
    files: tuple = ()
    solids: bool = True  # without any, schemes do not differ
    stops: bool = False  # a run is to be stopped, not to come to its end
    ranks: tuple = ()  # of the fluid, one for each run; default: one


@dataclass
class Steps:
    """A row that shows in single steps of the fluid only; step_report does all of them at once."""

    name: str
    asked: str
    judge: Callable  # of its values -> whether it is met, value


STEPS = (
    Steps("two discs, one through a corner", "fluid + solid − impulses ≤ 1e-12 a step", at_most(momentum=1e-12)),
    Steps("three discs that touch in one cell", "the same; loads in any order alike to 1e-12", at_most(shared=1e-12, order=1e-12)),
    Steps("discs that come late", "momentum to 1e-12; the way of one that was there to 1e-10 cells",
          at_most(inserted=1e-12, late=1e-10)),
    Steps("discs that go, and none at all", "momentum to 1e-12; a fluid without solids to 1e-13", at_most(removed=1e-12, none=1e-13)),
    Steps("a disc on a side, edge or corner", "solid fractions of one inside; its loads to 1e-13", at_most(map=0.0, loads=1e-13)),
    Steps("a disc that begins on a side, edge or corner", "the way of one inside to 1e-10 cells in 1000 steps", at_most(face=1e-10)),
    Steps("an array carried at 0.02, 0.05, 0.1 C", "drag drift ≤ 1 %; of BGK, TRT 1.5 % at 0.05, 6 % at 0.1", carried),
)


# ---- cases ---------------------------------------------------------------------------------------------------------

QUIET = {"output": {"fields_every": 100.0, "probe_every": 0.01}}
EACH = {"output": {"fields_every": 100.0, "probe_every": 1e-6}}  # step
FREE = {"numerics": {"cells_per_diameter": 10, "solid_term": "auto", "collision": "auto"}}


def gels():
    """Laws of the viscosity."""
    law = lambda **keys: {"fluid": {"viscosity": keys}}  # noqa: E731
    yield Hard("gel, n = 0.3, whole force at once, τ 0.5 … 120", "bounded; flow within 2 %", OWN / "gel_channel", [{}],
               gel_flow(0.01, 0.02), solids=False)
    yield Hard("mud below its yield stress, from rest", "bounded; creeps as a fluid of nu_max, within 1 %", OWN / "gel_channel",
               [law(yield_stress=0.8, shear_rate=40.0)], gel_flow(0.2373 * 0.003**2 / (12 * 2.4e-3), 0.01), solids=False)
    yield Hard("gel, nu_max at τ 500", "refused", OWN / "gel_channel", [law(nu_max=0.01001)], solids=False)
    yield Hard("gel, nu_min at τ - ½ = 5e-7", "refused", OWN / "gel_channel", [law(nu_min=1e-11)], solids=False)
    yield Hard("a disc in mud, twice and a fifth of the critical yield stress", "held; falls", OWN / "held_disc",
               [{}, law(yield_stress=0.0645)], held)


def hard_cases(full):
    """Those that blow something up; in the full report also those that ask for a number alone."""
    yield Hard("cylinder Re 100, D/h 10, open channel", "bounded, or refused", "cylinder_flow",
               [{"run": {"end_time": 12.0 if full else 6.0}}], files=("variant-d10.toml",))
    for re_text, nu in (("1e4", 1e-4), ("1e5", 1e-5)):
        for u in (0.05, 0.1, 0.2) if full else (0.1,):  # a run refuses 0.2; the operators have a test of their own there
            yield Hard(f"shear layer Re {re_text}, u/C {u}", "bounded", "shear_layer",
                       [{"fluid": {"kinematic_viscosity": nu}, "numerics": {"time_step": u / 128}}], solids=False)
    fast = merged(EACH, {"fluid": {"velocity_scale": 0.3}, "numerics": {"cells_per_diameter": 12}, "run": {"end_time": 0.3}})
    yield Hard("settling Re 310, D/h 12, τ 0.505", "force noise ≤ 5 % of the weight a step", "settling_disc", [fast],
               noise(0.1, 0.28), ("variant-glowinski2.toml",))
    for ratio in (1.0, 0.75, 0.5, 0.1):
        light = merged(QUIET, FREE, {"particles": {"density": 1000.0 * ratio, "start": [[0.01, 0.02]]},
                                     "fluid": {"velocity_scale": 0.15}, "run": {"end_time": 0.25}})
        yield Hard(f"free disc, ρ_s/ρ_f {ratio:g}", "at rest to 1e-10 C" if ratio == 1.0 else "stable, or refused",
                   "settling_disc", [light], rest if ratio == 1.0 else Hard.judge)
        if ratio == 0.1 and full:
            yield Hard("free disc, ρ_s/ρ_f 0.1, virtual mass 0.5, 1, 2, 4", "told: it rises alike", "settling_disc",
                       [merged(light, {"coupling": {"virtual_mass": mass}}) for mass in (0.5, 1.0, 2.0, 4.0)], rises,
                       solids=False)
        if ratio == 0.1:
            yield Hard("free disc, ρ_s/ρ_f 0.1, no virtual mass", "told: what the default is for", "settling_disc",
                       [merged(light, {"coupling": {"virtual_mass": 0.0}})], lambda runs: (None, "bounded"), solids=False)
    yield Hard("free disc, τ = 1.5", "bounded", "couette_disc",
               [{"numerics": {"time_step": 0.00333}, "run": {"end_time": 10.0}}])
    for tau, step, ratio in ((1.5, 0.00333, 1.0), (1.5, 0.00333, 1.5), (1.5, 0.00333, 1.9), (1.0, 0.00167, 1.0)) if full else ():
        viscous = {"numerics": {"time_step": step}, "particles": {"density": 1000.0 * ratio},
                   "coupling": {"virtual_mass": 0.0}, "run": {"end_time": 10.0}}
        yield Hard(f"free disc, τ = {tau}, ρ_s/ρ_f {ratio:g}, no virtual mass", "told: what the default is for",
                   "couette_disc", [viscous], lambda runs: (None, "bounded"), solids=False)
    yield from gels()
    yield Hard("pressure jump of 600 kPa into a packing", "overshoot < 10 %", "hydraulic_fracture",
               [{"output": {"fields_every": 2.5e-4, "probe_every": 1e-3}, "run": {"end_time": 0.003}}], overshoot,
               ("variant-cloud.toml",))
    yield Hard("channel between pressures, Δρ/ρ 0.03, 0.01, 0.003", "error told; the step's rule allows 0.03", "poiseuille",
               [{"fluid": {"velocity_scale": 0.0099}, "numerics": {"time_step": 3.125e-4 / (3 * 0.04 / 1000 / change)**0.5}}
                for change in (0.03, 0.01, 0.003)], channel, ("variant-pressure.toml",), solids=False)
    if not full:
        return
    for n in (20, 30):
        yield Hard(f"cylinder Re 100, D/h {n}, Re_h {220 / n:.1f}", "largest drag told: TRT up to Re_h 5", "cylinder_flow",
                   [{"numerics": {"cell": 0.1 / n}, "run": {"end_time": 8.0}}], street, ("variant-d10.toml",), solids=False)
    yield Hard("pressure jump, weak bonds: hundreds break at once", "bounded", "hydraulic_fracture",
               [merged(QUIET, {"run": {"end_time": 0.003}})], files=("variant-weak.toml",))
    yield Hard("cavity Re 10 000", "bounded", "lid_driven_cavity", [{"run": {"end_time": 100.0}}],
               files=("variant-re10000.toml",), solids=False)
    yield Hard("array, τ 0.505 … 1.5, D/h 10", "drag flat within ±1 %", "cylinder_array",
               [array_run(tau, 5e-5) for tau in (0.505, 0.6, 1.5)], flat)
    yield Hard("array, D/h 2, 3, 4, 6, 8", "error told; no claim below 4", "cylinder_array",
               [array_run(0.8, 1e-3 / n) for n in (4, 6, 8, 12, 16)], told)
    for stiffness in ((1e-4, 1e-3), (1e-2,)):
        yield Hard(f"array, springs of {', '.join(map(str, stiffness))}", "told: what the default is for", "cylinder_array",
                   [merged(array_run(0.8, 5e-5), {"numerics": {"scheme": "spring_immersed_boundary", "spring_stiffness": k}})
                    for k in stiffness], told, solids=False)
    pores = array_run(0.8, 2.5e-5, [(x, y) for x in (0.0, 5e-4) for y in (0.0, 5e-4)], 5.1e-4,
                      end_time=1e5 * step_of(0.8, 2.5e-5), steady_below=0.0)
    yield Hard("closed pores, 1e5 steps", "mass drift ≤ 1e-12", "cylinder_array", [pores], drift(1e-12))
    yield Hard("closed pores, 1e5 steps, single precision", "mass drift ≤ 1e-6", "cylinder_array",
               [merged(pores, {"numerics": {"precision": "single"}})], drift(1e-6))
    yield Hard("a disc too fast for its step", "stopped at 0.2 C", "settling_disc",
               [merged(QUIET, FREE, {"fluid": {"velocity_scale": 0.02}, "run": {"end_time": 0.5}})], stops=True)
    yield Hard("a disc faster than said", "warned of above 0.1 C", "settling_disc",
               [merged(QUIET, FREE, {"fluid": {"velocity_scale": 0.04}, "run": {"end_time": 0.4}})], warned)
    yield Hard("two discs in one cell, numbered either way", "the same ways to 1e-10 D", "drafting_kissing_tumbling",
               [merged(EACH, FREE, {"particles": {"start": start}, "run": {"end_time": 0.2}})
                for start in ([[0.01, 0.07], [0.0101, 0.06799]], [[0.0101, 0.06799], [0.01, 0.07]])], order)
    yield Hard("a disc through a periodic side", "the way of one half a period on to 1e-10 D", "disc_migration",
               [merged(EACH, {"particles": {"start": [[x, 0.009]]}, "run": {"end_time": 0.08}}) for x in (0.0075, 0.0025)],
               same_way(0.5))
    falling = merged(EACH, FREE, {"particles": {"start": [[0.0097, 0.0365]]}, "run": {"end_time": 0.42}})
    yield Hard("a disc through the border of two ranks", "the way on one rank to 1e-10 D", "settling_disc",
               [falling, falling], same_way(), ranks=(1, 2))
    yield Hard("settling Re 14, cells uncovered", "force jump ≤ 5 % of the weight a step", "settling_disc",
               [merged(EACH, FREE, {"run": {"end_time": 0.5}})], jump(0.1, 0.5))
    yield Hard("settling, Re_h 2, 5, 10, 20", "force noise a step told: TRT up to 5", "settling_disc",
               [merged(EACH, FREE, {"fluid": {"velocity_scale": 0.1, "kinematic_viscosity": 0.1 * 2.5e-4 / re_h},
                                    "run": {"end_time": 0.3}}) for re_h in (2, 5, 10, 20)], noises(0.15, 0.29), solids=False)
    yield Hard("1, 5, 15, 50 substeps", "fall velocity within 1 %", "settling_disc",
               [merged(FREE, {"particles": {"contact_stiffness": 200.0}, "coupling": {"substeps": n},
                              "output": {"fields_every": 100.0, "probe_every": 0.002}, "run": {"end_time": 0.5}})
                for n in (1, 5, 15, 50)], alike)
    yield Hard("a bond broken by the flow, 1, 5, 15, 50 substeps", "its time within 1 %", OWN / "bond_in_flow",
               [{"coupling": {"substeps": n}} for n in (1, 5, 15, 50)], breaks_alike)
    yield Hard("a hundred bonds that break at once", "momentum to 1e-12, energy to 1 %", OWN / "bond_burst", [{}], burst)
