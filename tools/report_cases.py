"""What tools/report runs: schemes, the cases with a reference and how to measure them, and where long scenes end early."""

import numpy as np
from pictures import read_table
from report_runs import merged

OURS, PAPERS, STAIRS = "ours", "papers", "staircase"
SCHEMES = {
    "default, bodies at rest: TRT, Holdych": (OURS, {}),
    "default, free bodies: TRT, layered Holdych": (OURS, {"solid_term": "layered_holdych"}),
    "TRT, layered Holdych, balanced weight": (OURS, {"solid_term": "layered_holdych", "weight": "balanced"}),
    "TRT by rule, Λ = 1/4": (None, {"magic": 0.25}),
    "TRT by rule, Λ = 1/12": (None, {"magic": 1 / 12}),
    "central moments, layered Noble–Torczynski":
        (None, {"collision": "central_moment", "solid_term": "layered_noble_torczynski"}),
    "TRT, Noble–Torczynski": (None, {"collision": "trt", "solid_term": "noble_torczynski"}),
    "papers: BGK, Noble–Torczynski": (PAPERS, {"collision": "bgk", "solid_term": "noble_torczynski"}),
    "BGK, Noble–Torczynski, B = ε": (None, {"collision": "bgk", "solid_term": "noble_torczynski", "weight": "fraction"}),
    "staircase: BGK, bounce-back": (STAIRS, {"collision": "bgk", "scheme": "bounce_back"}),
    "TRT, bounce-back": (STAIRS, {"collision": "trt", "scheme": "bounce_back"}),
    "TRT, interpolated bounce-back": (None, {"collision": "trt", "scheme": "interpolated_bounce_back"}),
    "TRT, implicit immersed boundary": (None, {"collision": "trt", "scheme": "implicit_immersed_boundary"}),
}


# ---- cases: name -> rows (label, family, overlays of places, files), and how to measure ----------------------------


PLACES = ((0, 0), (0.5, 0.5), (0.23, 0.41))  # of a body's centre within a cell


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
    for label, (family, numerics) in SCHEMES.items():
        for h in sides:
            if "Λ" in label and h < 2e-5:
                continue
            for tau in ((0.505, 0.6, 1.0, 1.5) if full else (0.6, 1.5)) + ((2.5,) if "default," in label else ()):
                slow = "interpolated" in label or "implicit" in label  # minutes a row
                if h < 2e-5 and tau < (1.0 if slow else 0.6) or slow and h < 5e-5 and tau < (0.6 if full else 1.0):
                    continue
                places = [array_run(tau, h, [(0.0005 + x * h, 0.0005 + y * h)], numerics=numerics) for x, y in PLACES]
                yield label, family, f"D/h {5.046e-4 / h:.0f}, τ {tau}", places, ()


SPHERE_SCHEMES = {  # in three dimensions, where the balanced weight is the default
    "default, bodies at rest: TRT, Holdych": (OURS, {}),
    "default, free bodies: TRT, layered Holdych": (OURS, {"solid_term": "layered_holdych"}),
    "default, D3Q27": (OURS, {"lattice": "D3Q27"}),
    "default, single precision": (OURS, {"precision": "single"}),
    "default, D3Q27, single precision": (OURS, {"lattice": "D3Q27", "precision": "single"}),
    "TRT, Holdych, viscous weight": (None, {"weight": "viscous"}),
    "central moments, layered Noble–Torczynski":
        (None, {"collision": "central_moment", "solid_term": "layered_noble_torczynski"}),
    "papers: BGK, Noble–Torczynski":
        (PAPERS, {"collision": "bgk", "solid_term": "noble_torczynski", "weight": "viscous"}),
    "staircase: BGK, bounce-back": (STAIRS, {"collision": "bgk", "scheme": "bounce_back"}),
    "TRT, bounce-back": (STAIRS, {"collision": "trt", "scheme": "bounce_back"}),
    "TRT, interpolated bounce-back": (None, {"collision": "trt", "scheme": "interpolated_bounce_back"}),
}


def sphere_rows(full):
    """Any of 12, 16, 24, 32 (48) cells a side; the long step is the rule's, the short one a sixth of it."""
    for label, (family, numerics) in SPHERE_SCHEMES.items():
        for n in (12, 16, 24, 32) + ((48,) if full else ()):
            for tau in (0.6, 1.5):
                if tau < 1.0 and n > (24 if full else 16):
                    continue
                h = 1e-3 / n
                places = [{"obstacle": [{"centre": [5e-4 + x * h, 5e-4 + y * h, 5e-4 + z * h], "diameter": 6.2035049e-4}],
                           "numerics": {**numerics, "cell": h, "time_step": step_of(tau, h)},
                           "run": {"end_time": 1.0}, "output": {"fields_every": 1.0, "probe_every": 0.1}}
                          for x, y, z in ((0, 0, 0), (0.5, 0.5, 0.5), (0.23, 0.41, 0.12))]
                yield label, family, f"D/h {0.62035 * n:.0f}, τ {tau}", places, ()


def cylinder_rows(full):
    for label, (family, numerics) in SCHEMES.items():
        if "free bodies" in label or "implicit" in label:
            continue
        for h in (0.01, 0.005) if full or family else (0.01,):
            yield label, family, f"D/h {0.1 / h:.0f}", [{"numerics": {**numerics, "cell": h}}], ()


def couette_rows(full):
    """The longest step of the rule (τ = 1.5) and shorter ones, which bounce-back pays for the most."""
    for label, (family, numerics) in SCHEMES.items():
        if "bodies at rest" in label or "implicit" in label or (label.startswith("BGK") and not family):
            continue
        for h in (2e-4, 1e-4) + ((5e-5,) if full and "Λ" not in label else ()):
            for tau in (0.6, 0.8, 1.5) if full else (0.8, 1.5):
                if "bounce_back" in numerics.get("scheme", "") and tau < 1.0 and h < (1.5e-4 if not full or tau < 0.8 else 9e-5):
                    continue
                centres = [[0.0038 + x * h, 0.0038 + y * h] for x, y in PLACES]
                places = [{"obstacle": [{"centre": c, "diameter": 0.0064, "hollow": True},
                                        {"centre": c, "diameter": 0.0032, "spin": 1.0}],
                           "numerics": {**numerics, "cell": h, "time_step": step_of(tau, h)}} for c in centres]
                yield label, family, f"gap/h {1.6e-3 / h:.0f}, τ {tau}", places, ()


def settling_rows(full):
    fall = {"run": {"end_time": 0.6}, "output": {"fields_every": 0.6, "probe_every": 0.002}}
    for label, (family, numerics) in SCHEMES.items():
        if "bodies at rest" in label or "implicit" in label or "B = ε" in label:
            continue
        for cells in (5, 10, 20) + ((40,) if full and "Λ" not in label else ()):
            coupling = {"substeps": 1} if family == PAPERS else {}
            overlay = merged(fall, {"numerics": {"collision": "auto", "solid_term": "auto", **numerics,
                                                 "cells_per_diameter": cells}, "coupling": coupling})
            if coupling:  # soft enough for one solid step a fluid step; it falls, and touches nothing until then
                overlay = merged(overlay, {"particles": {"contact_stiffness": 100.0}})
            yield label, family, f"D/h {cells}", [overlay], ()
    for text, change in (("step × 2", {"fluid": {"velocity_scale": 0.03}}), ("step / 4", {"fluid": {"velocity_scale": 0.24}}),
                         ("overlapped", {"coupling": {"schedule": "overlapped"}}),
                         ("3 fluid steps an interval", {"coupling": {"fluid_steps": 3}}),
                         ("no inertia of the fluid inside", {"coupling": {"inner_inertia": False}}),
                         ("5 substeps", {"coupling": {"substeps": 5}}), ("50 substeps", {"coupling": {"substeps": 50}})):
        yield SCHEMES_FREE, OURS, f"D/h 10, {text}", [merged(fall, {"numerics": {"cells_per_diameter": 10}}, change)], ()


SCHEMES_FREE = "default, free bodies: TRT, layered Holdych"
COUETTE = 4 * np.pi * 1e-3 * 1.0 * 0.0016**2 * 0.0032**2 / (0.0032**2 - 0.0016**2)


def couette_torque(run, module):
    table = read_table(run.folder / "obstacles.csv")
    return -table["torque"][table["obstacle"] == 2][-1] / run.parameters["depth"]


CASES_OF = {  # scene, rows, measure, reference, its uncertainty, source
    "array": ("cylinder_array", array_rows, lambda run, m: m.drag(run), 51.526949, 3e-4,
              "drag of a square array, Stokes flow; spectral, Sangani and Acrivos 1982"),
    "spheres": ("sphere_array", sphere_rows, lambda run, m: m.drag(run), 4.292, 2e-4,
                "drag of a cubic array of spheres, Stokes flow; Zick and Homsy 1982"),
    "cylinder": ("cylinder_flow", cylinder_rows, lambda run, m: m.coefficients(run)[1][-1], 5.57953523384, 1e-6,
                 "drag of a cylinder at Re 20; Schäfer and Turek 2D-1"),
    "couette": ("taylor_couette", couette_rows, couette_torque, COUETTE, 1e-9, "torque between cylinders; exact"),
    "settling": ("settling_disc", settling_rows, lambda run, m: m.reynolds(run)[1].max(), 17.345, 4.3e-3,
                 "largest Re of a settling disc; 17.27 … 17.42 in the literature"),
}

# ---- only what a scene needs: where a long scene ends early [s] ------------------------------------------------------

BEGINNINGS = {"couette_disc": 30.0, "critical_gradient": 0.1, "cylinder_flow": 4.0, "disc_migration": 0.835,
              "drafting_kissing_tumbling": 0.5, "hydraulic_fracture": 0.001, "lid_driven_cavity": 8.0, "lid_driven_cavity_3d": 0.5, "sedimentation": 0.04,
              "settling_disc": 0.5, "soil_erosion": 0.005, "soil_erosion_3d": 0.01, "suspension_migration": 0.0104175,
              "ten_cate_sphere": 0.6}
