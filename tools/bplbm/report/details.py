"""What a row of the report says beside error and time: how the run was made, and how calm it was."""

import re
import tomllib

import numpy as np

from bplbm.project import CASES
from bplbm.report.stability import step_values
from bplbm.results import read_table

LOADS = {"couette": "torque", "spin": "tz", "settling": "fy"}  # what is measured; fx in all other cases
FEW = 8  # records, too few to judge noise by


def made_with(run, overlay, dimension):
    """Lattice, precision, operator, scheme and weight of a run: the scene's, the overlay's, or what the run took."""
    log = (run.folder / "lbm.log").read_text()
    scene = tomllib.loads((CASES / run.summary["scene"] / "scene.toml").read_text())
    numerics = {**scene.get("numerics", {}), **overlay.get("numerics", {})}
    said = {"collision": re.search(r"^collision +(\w+)", log, re.MULTILINE),
            "scheme": re.search(r"^solids +(\w+)", log, re.MULTILINE),
            "solid_term": re.search(r"^solids +\w+, (\w+)", log, re.MULTILINE)}
    made = {"lattice": "D2Q9" if dimension == 2 else "D3Q19", "precision": "double", "scheme": "immersed_moving_boundary",
            **{key: found.group(1) for key, found in said.items() if found}}
    keys = ("lattice", "precision", "collision", "scheme", "solid_term")
    made.update({key: numerics[key] for key in keys if numerics.get(key, "auto") != "auto"})
    if made["scheme"] == "immersed_moving_boundary" and made.get("solid_term", "").endswith("resistance"):
        return made  # it has no weight
    if made["scheme"] == "immersed_moving_boundary":
        made["weight"] = numerics.get("weight", "viscous" if dimension == 2 else "balanced")
    else:
        made.pop("solid_term", None)
    return made


def load_noise(case, run):
    """Standard deviation and largest departure [%] of the load that is measured, over its mean, in the last quarter of
    the records (of a particle without the last one, which repeats a load); what changes linearly with time is none.
    Empty where there are few records."""
    path = run.folder / "obstacles.csv"
    table = read_table(path) if path.exists() else run.probes()
    mine = table["obstacle"] == table["obstacle"].max() if "obstacle" in table else table["time"] < table["time"][-1]
    load, time = table[LOADS.get(case, "fx")][mine], table["time"][mine]
    load, time = load[-(len(load) // 4):], time[-(len(time) // 4):]
    if len(load) < FEW:
        return {}
    rest = load - np.polyval(np.polyfit(time, load, 1), time)
    return {"load_sigma_percent": 100 * rest.std() / abs(load.mean()),
            "load_peak_percent": 100 * np.abs(rest).max() / abs(load.mean())}


def details(case, run, overlay, again):
    """Columns of a row."""
    pressure, dimension = run.frame(run.frames()[-1][1])["pressure"], 3 if "box_z" in run.parameters else 2
    made, p = made_with(run, overlay, dimension), run.parameters
    of_density = p["density"] * (p["cell"] / p["time_step"])**2 / 3
    row = {**made, "solid_scheme": made["scheme"], "cores": 1, "u_over_c": run.summary["ma_paper"], "density_change": np.nanmax(np.abs(pressure)) / of_density,
           **load_noise(case, run)}
    if dimension == 2:
        choice = {key: made[key] for key in ("collision", "scheme", "solid_term", "weight") if key in made}
        row["momentum_rest_a_step"] = step_values(choice, again)["momentum"]
    del row["scheme"]  # which is the row's own name
    return row
