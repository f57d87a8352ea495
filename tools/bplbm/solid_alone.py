"""A scene without a fluid: LIGGGHTS alone.

Its scene.toml has no [fluid]. [box], [particles] and [run] become the script variables that the fluid offers to the
other scenes, under the same names, so that one script may serve both; all in SI units.
"""

import json
import math
import pathlib
import re
import tomllib

from bplbm.placement import UNBOUND

KEYS = {"box": {"size"}, "particles": {"diameter", "density", "contact_stiffness", "variables"},
        "run": {"time_step", "end_time"}}


# What becomes a script variable: as lbm_solver/io/script_variables has it.
OURS = {"scene_folder", "out_folder"}  # besides those of the scene: where the script includes files from, and writes
ONE_WORD = re.compile(r"(?!/|(.*/)?\.\.(/|$)|-[^0-9.])[A-Za-z0-9_.,:/+*=-]+")


class Mistake(ValueError):
    """What is wrong with the scene, and what to do."""


def merged(base, overlay):
    """Tables within tables: the overlay's values win."""
    both = dict(base)
    for key, value in overlay.items():
        both[key] = merged(both[key], value) if isinstance(value, dict) and isinstance(both.get(key), dict) else value
    return both


def read(files):
    """The scene of a file and its overlays."""
    scene = {}
    for file in files:
        try:
            scene = merged(scene, tomllib.loads(pathlib.Path(file).read_text()))
        except (OSError, ValueError) as error:
            raise Mistake(f"{file}: {error}") from None
    return scene


def positive(value, name):
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value) or value <= 0:
        raise Mistake(f"{name} = {value}: must be a positive number, in SI units")
    return float(value)


def check_keys(scene):
    for table, content in scene.items():
        if table == "title":
            continue
        if table not in KEYS:
            raise Mistake(f"knows no [{table}]; a scene of LIGGGHTS alone has {', '.join(f'[{k}]' for k in KEYS)}")
        for key in set(content) - KEYS[table]:
            raise Mistake(f"knows no {table}.{key}; [{table}] has: {', '.join(sorted(KEYS[table]))}")
    for table, keys in KEYS.items():
        for key in sorted(keys - {"variables"} - set(scene.get(table, {}))):
            raise Mistake(f"lacks {table}.{key}")


def variables(scene, until=None):
    """Script variables by name, as text. until: end time [s] instead of the scene's."""
    check_keys(scene)
    size, particles, run = scene["box"]["size"], scene["particles"], scene["run"]
    if not isinstance(size, list) or len(size) not in (2, 3):
        raise Mistake(f"box.size = {size}: must be two or three lengths in m")
    diameter = particles["diameter"] if isinstance(particles["diameter"], list) else [particles["diameter"]]
    step, end = positive(run["time_step"], "run.time_step"), until or positive(run["end_time"], "run.end_time")
    found = {"dimension": len(size), "depth": 1.0, "z_lo": -0.5, "z_hi": 0.5, "boundary_z": "p", "walls_z": 0}
    for axis, length in zip("xyz", size):
        found |= {f"{axis}_lo": 0.0, f"{axis}_hi": positive(length, "box.size"), f"boundary_{axis}": "f",
                  f"walls_{axis}": 1}
    found |= {"restart": 0, "restart_file": "none", "solid_step": step, "solid_steps_total": max(1, round(end / step)),
              "diameter_min": positive(min(diameter), "particles.diameter"),
              "diameter_max": positive(max(diameter), "particles.diameter"),
              "density_max": positive(particles["density"], "particles.density"),
              "contact_stiffness": positive(particles["contact_stiffness"], "particles.contact_stiffness")}
    own = particles.get("variables", {})
    for name, value in own.items():
        if name in found or name in OURS:
            raise Mistake(f"particles.variables.{name}: the scene gives this variable already; choose another name")
        if (not re.fullmatch(r"[A-Za-z0-9_]+", name) or not isinstance(value, (int, float, str))
                or not ONE_WORD.fullmatch(str(value))):
            raise Mistake(f"particles.variables.{name} = {value!r}: a script variable is a word of letters, digits and _, "
                          "its value a number or one word of these and . , : / + - * =, no path out of the scene's folder")
    return {name: str(int(value) if isinstance(value, bool) else value) for name, value in (found | own).items()}


def numbers(found):
    """Those variables that are numbers: what plots and summary.json want to know."""
    kept = {}
    for name, text in found.items():
        try:
            kept[name] = float(text)
        except ValueError:
            pass
    return kept


def command(liggghts, script, out, found, ranks):
    """The mpirun line."""
    line = ["mpirun", *UNBOUND, "-np", str(ranks), str(liggghts), "-in", str(script),
            "-log", str(out / "liggghts.log"), "-screen", "none", "-var", "out_folder", str(out)]
    for name, text in found.items():
        line += ["-var", name, text]
    return line


def error_in(log):
    """LIGGGHTS' last words, if it ended itself."""
    lines = log.read_text(errors="replace").splitlines() if log.exists() else []
    found = [line for line in lines if line.startswith("ERROR")]
    return found[-1] if found else None


def write_summary(out, scene, chosen_set, variant, found, wall_seconds):
    """summary.json as lbm writes it, as far as there is something to say."""
    steps = int(found["solid_steps_total"])
    made = {"scene": scene, "set": chosen_set, "variant": variant, "steps": steps,
            "physical_seconds": steps * float(found["solid_step"]), "wall_seconds": wall_seconds,
            "parameters": numbers(found), "results": []}
    (out / "summary.json").write_text(json.dumps(made, indent=2) + "\n")
