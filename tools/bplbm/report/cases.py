"""What tools/report runs: schemes, the cases with a reference and how to measure them, and where long scenes end early."""

import math
import tomllib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bplbm.report.runs import merged
from bplbm.results import read_table

OURS, FORMER, PAPERS, STAIRS = "ours", "former", "papers", "staircase"


@dataclass(frozen=True)
class Scheme:
    """A choice of numerics that is compared."""

    family: str | None  # OURS …, or none: compared with nobody
    numerics: dict


@dataclass(frozen=True)
class Choice:
    """A row to measure: one run for each place of the body within a cell."""

    scheme: str
    family: str | None
    size: str
    places: list  # overlays
    files: tuple = ()


@dataclass(frozen=True)
class Case:
    """What is measured, and against what."""

    scene: str
    rows: Callable  # of whether the report is full -> choices
    value: Callable  # of a run and the scene's plot.py -> number
    reference: float
    uncertainty: float  # of the reference, relative
    source: str


AT_REST = ("default, bodies at rest: TRT, resistance", "TRT, Holdych (former default)")
FREE = ("default, free bodies: TRT, layered resistance", "TRT, layered Holdych (former default)")
SCHEMES = {
    AT_REST[0]: Scheme(OURS, {}),
    FREE[0]: Scheme(OURS, {"solid_term": "layered_resistance"}),
    AT_REST[1]: Scheme(FORMER, {"solid_term": "holdych"}),
    FREE[1]: Scheme(FORMER, {"solid_term": "layered_holdych"}),
    "TRT by rule, Λ = 3/16": Scheme(None, {"magic": 3 / 16}),
    "TRT by rule, Λ = 1/4": Scheme(None, {"magic": 0.25}),
    "central moments, layered Noble–Torczynski":
        Scheme(None, {"collision": "central_moment", "solid_term": "layered_noble_torczynski"}),
    "TRT, Noble–Torczynski": Scheme(None, {"collision": "trt", "solid_term": "noble_torczynski"}),
    "papers: BGK, Noble–Torczynski": Scheme(PAPERS, {"collision": "bgk", "solid_term": "noble_torczynski"}),
    "BGK, Noble–Torczynski, B = ε": Scheme(None, {"collision": "bgk", "solid_term": "noble_torczynski", "weight": "fraction"}),
    "staircase: BGK, bounce-back": Scheme(STAIRS, {"collision": "bgk", "scheme": "bounce_back"}),
    "TRT, bounce-back": Scheme(STAIRS, {"collision": "trt", "scheme": "bounce_back"}),
    "TRT, interpolated bounce-back": Scheme(None, {"collision": "trt", "scheme": "interpolated_bounce_back"}),
    "TRT, implicit immersed boundary": Scheme(None, {"collision": "trt", "scheme": "implicit_immersed_boundary"}),
}
SPHERE_SCHEMES = {  # in three dimensions, where the balanced weight is that of Holdych's
    AT_REST[0]: Scheme(OURS, {}),
    FREE[0]: Scheme(OURS, {"solid_term": "layered_resistance"}),
    AT_REST[1]: Scheme(FORMER, {"solid_term": "holdych"}),
    FREE[1]: Scheme(FORMER, {"solid_term": "layered_holdych"}),
    "default, D3Q27": Scheme(OURS, {"lattice": "D3Q27"}),
    "default, single precision": Scheme(OURS, {"precision": "single"}),
    "default, D3Q27, single precision": Scheme(OURS, {"lattice": "D3Q27", "precision": "single"}),
    "central moments, layered Noble–Torczynski":
        Scheme(None, {"collision": "central_moment", "solid_term": "layered_noble_torczynski"}),
    "papers: BGK, Noble–Torczynski":
        Scheme(PAPERS, {"collision": "bgk", "solid_term": "noble_torczynski", "weight": "viscous"}),
    "staircase: BGK, bounce-back": Scheme(STAIRS, {"collision": "bgk", "scheme": "bounce_back"}),
    "TRT, bounce-back": Scheme(STAIRS, {"collision": "trt", "scheme": "bounce_back"}),
    "TRT, interpolated bounce-back": Scheme(None, {"collision": "trt", "scheme": "interpolated_bounce_back"}),
}
SLOW = ("interpolated", "implicit")  # minutes a row


def compared(schemes, without=()):
    """Only the default, the one before, the papers' scheme and the staircase."""
    return {label: choice for label, choice in schemes.items()
            if choice.family and label not in without and not label.startswith(("default, D3", "default, single", "TRT, bounce"))}


# ---- rows of the cases, and how to measure -------------------------------------------------------------------------


PLACES = ((0, 0), (0.5, 0.5), (0.23, 0.41))  # of a body's centre within a cell
SPHERE_PLACES = ((0, 0, 0), (0.5, 0.5, 0.5), (0.23, 0.41, 0.12))
SPIN, TURN = 0.12, 0.4  # rad/s, of a sphere and of a cylinder


def step_of(tau, h):
    """Time step [s] of a relaxation time in water, whose viscosity is 1e-6 m²/s."""
    return (tau - 0.5) / 3 * h * h / 1e-6


def array_run(tau, h, centres=((5e-4, 5e-4),), diameter=5.046265044e-4, numerics=(), **run):
    """Overlay of cylinder_array: cylinders [m] on cells of h, at a relaxation time."""
    return {"obstacle": [{"centre": list(centre), "diameter": diameter} for centre in centres],
            "numerics": {**dict(numerics), "cell": h, "time_step": step_of(tau, h)},
            "run": {"end_time": 8.0, **run}, "output": {"fields_every": 8.0, "probe_every": 0.1}}


def array_rows(full):
    sides = [1e-4, 5e-5, 2.5e-5] + ([1.25e-5] if full else [])
    for label, scheme in SCHEMES.items():
        family, numerics = scheme.family, scheme.numerics
        if "Λ" in label and not full:
            continue
        slow = any(word in label for word in SLOW)
        for h in sides:
            if "Λ" in label and h < 2e-5:
                continue
            for tau in ((0.505, 0.6, 1.0, 1.5) if full else (0.6, 1.5)) + ((2.5,) if label in AT_REST + FREE else ()):
                if h < 2e-5 and tau < (1.0 if slow else 0.6) or slow and h < 5e-5 and tau < (0.6 if full else 1.0):
                    continue
                places = [array_run(tau, h, [(0.0005 + x * h, 0.0005 + y * h)], numerics=numerics) for x, y in PLACES]
                yield Choice(label, family, f"D/h {5.046e-4 / h:.0f}, τ {tau}", places)


def sphere_rows(full):
    """Any of 12, 16, 24, 32 (48) cells a side; the long step is the rule's, the short one a sixth of it."""
    for label, scheme in SPHERE_SCHEMES.items():
        family, numerics = scheme.family, scheme.numerics
        if "D3Q27, single" in label and not full:
            continue
        for n in (12, 16, 24, 32) + ((48,) if full else ()):
            for tau in (0.6, 1.5):
                if tau < 1.0 and n > (24 if full else 16):
                    continue
                h = 1e-3 / n
                places = [{"obstacle": [{"centre": [5e-4 + x * h, 5e-4 + y * h, 5e-4 + z * h], "diameter": 6.2035049e-4}],
                           "numerics": {**numerics, "cell": h, "time_step": step_of(tau, h)},
                           "run": {"end_time": 1.0}, "output": {"fields_every": 1.0, "probe_every": 0.1}}
                          for x, y, z in SPHERE_PLACES]
                yield Choice(label, family, f"D/h {0.62035 * n:.0f}, τ {tau}", places)


def sphere_at(n, place, diameter, size=1e-3, **spin):
    """Obstacle in the middle of a box of n cells a side, at a place in a cell."""
    return {"centre": [size / n * (n // 2 + x) for x in place], "diameter": diameter, **spin}


def dense_rows(full, dimension, diameter, cells, end):
    """Bodies [m] in a box of 1 mm, some numbers of cells, at rest; all schemes take the same time to the end."""
    for label, scheme in compared(SCHEMES if dimension == 2 else SPHERE_SCHEMES).items():
        family, numerics = scheme.family, scheme.numerics
        for n in cells + ((3 * cells[-1] // 2,) if full else ()):
            for tau in (0.6, 1.5):
                if tau < 1.0 and n not in (cells if full else cells[1:2]):
                    continue
                step = step_of(tau, 1e-3 / n)
                steps = round(end / step)  # fields of the last two of them
                places = [{"obstacle": [sphere_at(n, place, diameter)],
                           "numerics": {**numerics, "cell": 1e-3 / n, "time_step": step},
                           "run": {"end_time": (steps - 0.5) * step, "steady_below": 0.0},  # halves: so that rounding plays no part
                           "output": {"fields_every": (steps - 1.5) * step, "probe_every": end / 40}}
                          for place in (PLACES if dimension == 2 else SPHERE_PLACES)]
                yield Choice(label, family, f"D/h {1e3 * diameter * n:.1f}, τ {tau}", places)


def spin_rows(full):
    """A sphere of 1/3 mm that spins in a periodic box of six radii."""
    for label, scheme in compared(SPHERE_SCHEMES, without=AT_REST).items():
        family, numerics = scheme.family, scheme.numerics
        for n in (18, 24, 30) + ((48,) if full else ()):
            for tau in (0.6, 1.5):
                if tau < 1.0 and n > (24 if full else 18):
                    continue
                places = [{"obstacle": [sphere_at(n, place, 1e-3 / 3, spin=[0.0, 0.0, SPIN])],
                           "fluid": {"body_force": [0.0, 0.0, 0.0]},
                           "numerics": {**numerics, "cell": 1e-3 / n, "time_step": step_of(tau, 1e-3 / n)},
                           "run": {"end_time": 0.3}, "output": {"fields_every": 0.3, "probe_every": 0.3 / 40}}
                          for place in SPHERE_PLACES]
                yield Choice(label, family, f"D/h {n / 3:.0f}, τ {tau}", places)


def cylinder_rows(full):
    for label, scheme in SCHEMES.items():
        family, numerics = scheme.family, scheme.numerics
        if label in FREE or "implicit" in label or ("Λ" in label and not full):
            continue
        for h in (0.01, 0.005) if full or family else (0.01,):
            yield Choice(label, family, f"D/h {0.1 / h:.0f}", [{"numerics": {**numerics, "cell": h}}])


def couette_rows(full):
    """The longest step of the rule (τ = 1.5) and shorter ones, which bounce-back pays for the most. The cylinder turns
    so slowly that the long step is within 0.1 C, too."""
    for label, scheme in SCHEMES.items():
        family, numerics = scheme.family, scheme.numerics
        if label in AT_REST or "implicit" in label or (label.startswith("BGK") and not family) or "Λ" in label:
            continue
        for gap in (6, 8, 12) + ((16, 32) if full else ()):
            for tau in (0.6, 0.8, 1.5) if full else (0.8, 1.5):
                if "bounce_back" in numerics.get("scheme", "") and tau < 1.0 and gap > (8 if not full or tau < 0.8 else 16):
                    continue
                h = 1.6e-3 / gap
                side = math.ceil(4.75 * gap)  # cells of the box
                centres = [[h * (side // 2 + x), h * (side // 2 + y)] for x, y in PLACES]
                places = [{"box": {"size": [side * h, side * h]},
                           "obstacle": [{"centre": c, "diameter": 0.0064, "hollow": True},
                                        {"centre": c, "diameter": 0.0032, "spin": TURN}],
                           "numerics": {**numerics, "cell": h, "time_step": step_of(tau, h)}} for c in centres]
                yield Choice(label, family, f"gap/h {gap}, τ {tau}", places)


def settling_rows(full):
    fall = {"run": {"end_time": 0.6}, "output": {"fields_every": 0.6, "probe_every": 0.002}}
    for label, scheme in SCHEMES.items():
        family, numerics = scheme.family, scheme.numerics
        if label in AT_REST or "implicit" in label or "B = ε" in label or ("Λ" in label and not full):
            continue
        for cells in (5, 10, 20) + ((40,) if full and "Λ" not in label else ()):
            coupling = {"substeps": 1} if family == PAPERS else {}
            overlay = merged(fall, {"numerics": {"collision": "auto", "solid_term": "auto", **numerics,
                                                 "cells_per_diameter": cells}, "coupling": coupling})
            if coupling:  # soft enough for one solid step a fluid step; it falls, and touches nothing until then
                overlay = merged(overlay, {"particles": {"contact_stiffness": 100.0}})
            yield Choice(label, family, f"D/h {cells}", [overlay])
    for text, change in (("step × 2", {"fluid": {"velocity_scale": 0.03}}), ("step / 4", {"fluid": {"velocity_scale": 0.24}}),
                         ("overlapped", {"coupling": {"schedule": "overlapped"}}),
                         ("3 fluid steps an interval", {"coupling": {"fluid_steps": 3}}),
                         ("no inertia of the fluid inside", {"coupling": {"inner_inertia": False}}),
                         ("5 substeps", {"coupling": {"substeps": 5}}), ("50 substeps", {"coupling": {"substeps": 50}})):
        yield Choice(FREE[0], OURS, f"D/h 10, {text}", [merged(fall, {"numerics": {"cells_per_diameter": 10}}, change)])


COUETTE = 4 * np.pi * 1e-3 * TURN * 0.0016**2 * 0.0032**2 / (0.0032**2 - 0.0016**2)
STOKES = 8 * np.pi * 1e-3 * (1e-3 / 6)**3 * SPIN / (1 - 4 / 3 * np.pi / 6**3)


def couette_torque(run, module):
    table = read_table(run.folder / "obstacles.csv")
    return -table["torque"][table["obstacle"] == 2][-1] / run.parameters["depth"]


def spin_torque(run, module):
    return -read_table(run.folder / "obstacles.csv")["tz"][-1]


def dense_drag(run, module):
    """F/(mu U) [1 in two dimensions, m in three]. The mean flux U is that of all cells, since there may be no section
    without covered ones. Fluid inside of a body may ring from one step to the next, so it is the mean of two steps."""
    p, names = run.parameters, [name for _, name in run.frames()[-2:]]
    u = sum(run.frame(name)["velocity"][..., 0].astype(float) for name in names) / 2
    force = read_table(run.folder / "obstacles.csv")["fx"][-1]
    overlay = tomllib.loads((run.folder / "overlay.toml").read_text())
    if "bounce_back" in overlay["numerics"].get("scheme", ""):
        body = overlay["obstacle"][0]
        cells = np.meshgrid(*[(np.arange(n) + 0.5) * p["cell"] for n in u.shape], indexing="ij")[::-1]  # x first
        far = sum((x - c)**2 for x, c in zip(cells, body["centre"], strict=True))
        flux = u[far > body["diameter"]**2 / 4].sum() / u.size
    else:
        flux = sum(run.flux(name)[0] for name in names) / 2
    return force / (p["depth"] if u.ndim == 2 else 1.0) / (p["density"] * p["kinematic_viscosity"] * flux)


def dense_spheres(fraction, drag, cells, end, uncertainty, source):
    """A cubic array with the drag F/(6 pi mu a U) = `drag`."""
    diameter = 2e-3 * (0.75 * fraction / np.pi)**(1 / 3)
    return Case("sphere_array", lambda full: dense_rows(full, 3, diameter, cells, end), dense_drag,
                3 * np.pi * diameter * drag, uncertainty, source)


CASES_OF = {
    "array": Case("cylinder_array", array_rows, lambda run, m: m.drag(run), 51.526949, 3e-4,
                  "drag of a square array, Stokes flow; spectral, Sangani and Acrivos 1982"),
    "spheres": Case("sphere_array", sphere_rows, lambda run, m: m.drag(run), 4.292, 2e-4,
                    "drag of a cubic array of spheres, Stokes flow; Zick and Homsy 1982"),
    "dense_discs": Case("cylinder_array", lambda full: dense_rows(full, 2, 7.136496e-4, (7, 10, 14, 20, 28, 40), 2.0), dense_drag,
                        217.894315, 3e-4, "drag of a square array of solid fraction 0.4, Stokes flow; spectral"),
    "dense_spheres": dense_spheres(0.343, 15.4, (7, 9, 12, 18, 24), 1.0, 4e-3,
                                   "drag of a cubic array of solid fraction 0.343, Stokes flow; Zick and Homsy 1982"),
    "touching_spheres": dense_spheres(np.pi / 6, 42.1, (6, 8, 12, 16, 24), 1.0, 2e-3,
                                      "drag of a cubic array of spheres that touch, Stokes flow; Zick and Homsy 1982"),
    "cylinder": Case("cylinder_flow", cylinder_rows, lambda run, m: m.coefficients(run)[1][-1], 5.57953523384, 1e-6,
                     "drag of a cylinder at Re 20; Schäfer and Turek 2D-1"),
    "couette": Case("taylor_couette", couette_rows, couette_torque, COUETTE, 1e-9, "torque between cylinders; exact"),
    "spin": Case("sphere_array", spin_rows, spin_torque, STOKES, 1e-3,
                 "torque on a sphere that spins in a periodic box of six radii; Zuzovsky et al. 1983"),
    "settling": Case("settling_disc", settling_rows, lambda run, m: m.reynolds(run)[1].max(), 17.345, 4.3e-3,
                     "largest Re of a settling disc; 17.27 … 17.42 in the literature"),
}

GROUPS = {"dense": ("dense_discs", "dense_spheres", "touching_spheres"), "torque": ("couette", "spin")}  # names for several

# ---- only what a scene needs: where a long scene ends early [s] ------------------------------------------------------

BEGINNINGS = {"couette_disc": 30.0, "critical_gradient": 0.1, "cylinder_flow": 4.0, "disc_migration": 0.835,
              "drafting_kissing_tumbling": 0.5, "hydraulic_fracture": 0.001, "lid_driven_cavity": 8.0, "lid_driven_cavity_3d": 0.5, "sedimentation": 0.04,
              "settling_disc": 0.5, "soil_erosion": 0.005, "soil_erosion_3d": 0.01, "suspension_migration": 0.0104175,
              "ten_cate_sphere": 0.6}
