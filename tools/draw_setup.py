"""Draws a scene's box, sides, obstacles, particles and drives, as its files describe them.

    tools/draw_setup soil_erosion disc_migration

writes cases/SCENE/pictures/setup.png.
"""

import argparse
import pathlib
import re
import sys
import tomllib

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PatchCollection
from launch import scenes
from pictures import read_table

CASES = pathlib.Path(__file__).resolve().parent.parent / "cases"
COLOR = {"pressure": "tab:blue", "velocity": "tab:green", "moving_wall": "tab:orange", "outflow": "tab:purple"}
ATOM = re.compile(r"create_atoms\s+\d+\s+single\s+(\S+)\s+(\S+)")
DIAMETER = re.compile(r"set\s+atom\s+(\d+)\s+diameter\s+(\S+)")


def script_discs(folder):
    """Discs x, y, diameter [m] that the scene's script creates with plain numbers, file by file."""
    discs = []
    for path in sorted(folder.glob("*.liggghts")):
        text = path.read_text()
        places = [(float(x), float(y)) for x, y in ATOM.findall(text) if "$" not in x + y]
        diameters = {int(i): float(d) for i, d in DIAMETER.findall(text)}
        if diameters:
            discs += [(x, y, diameters[i + 1]) for i, (x, y) in enumerate(places)]
        elif places:
            gaps = np.linalg.norm(np.diff(places, axis=0), axis=1)
            discs += [(x, y, gaps.min()) for x, y in places]  # grains in a row touch
    return discs


def discs_of(scene, folder):
    p = scene.get("particles", {})
    discs = [(x, y, np.max(p["diameter"])) for x, y in p.get("start", [])] if p else []
    if "grains" in scene:
        table = read_table(folder / scene["grains"]["file"])
        discs += list(zip(table["x"], table["y"], table["diameter"]))
    return discs + script_discs(folder)


def side_line(side, box, start, end):
    lx, ly = box
    return {"left": ([0, 0], [start, end]), "right": ([lx, lx], [start, end]),
            "bottom": ([start, end], [0, 0]), "top": ([start, end], [ly, ly])}[side]


def words(boundary):
    kind = boundary["kind"].replace("_", " ")
    if "pressure" in boundary:
        return f"{kind} {boundary['pressure'] / 1e3:g} kPa" if boundary["pressure"] else f"{kind} 0"
    if "velocity" in boundary:
        return f"{kind} {np.hypot(*boundary['velocity']):g} m/s {boundary.get('profile', '')}".rstrip()
    return kind


def draw_sides(axes, scene, box, unit):
    lx, ly = box
    for key, sides in (("sides_x", ("left", "right")), ("sides_y", ("bottom", "top"))):
        periodic = scene["box"].get(key, "wall") == "periodic"
        for side in sides:
            x, y = side_line(side, box, 0, ly if side in ("left", "right") else lx)
            axes.plot(x, y, "--" if periodic else "-", color="0.55" if periodic else "k", linewidth=1 if periodic else 2.5,
                      solid_capstyle="projecting", zorder=3)
    offsets = {"left": (-30, 0, "right"), "right": (6, 0, "left"), "bottom": (0, -32, "center"), "top": (0, 6, "center")}
    for b in scene.get("boundary", []):
        length = ly if b["side"] in ("left", "right") else lx
        x, y = side_line(b["side"], box, b.get("from", 0) / unit, b["to"] / unit if "to" in b else length)
        axes.plot(x, y, color=COLOR[b["kind"]], linewidth=5, solid_capstyle="butt", zorder=4)
        dx, dy, align = offsets[b["side"]]
        axes.annotate(words(b), (np.mean(x), np.mean(y)), xytext=(dx, dy), textcoords="offset points", ha=align,
                      va="center" if dx else "bottom", color=COLOR[b["kind"]], rotation=90 if dx else 0)


def drive_text(scene):
    fluid, box = scene["fluid"], scene["box"]
    parts = [f"ρ = {fluid['density']:g} kg/m³, ν = {fluid['kinematic_viscosity']:g} m²/s"]
    if any(fluid.get("gravity", [])):
        parts.append(f"g = {np.hypot(*fluid['gravity']):g} m/s² ↓")
    if any(fluid.get("body_force", [])):
        parts.append(f"body force {np.hypot(*fluid['body_force']):g} m/s² →")
    if any(box.get("pressure_jump", [])):
        parts.append(f"pressure jump {np.max(np.abs(box['pressure_jump'])):g} Pa")
    if "particles" in scene:
        d = np.atleast_1d(scene["particles"]["diameter"]) * 1e3
        parts.append(f"discs {' … '.join(f'{v:g}' for v in d)} mm, ρ_s = {np.max(scene['particles']['density']):g} kg/m³")
    return "\n".join(parts)


def read_scene(folder):
    """The scene as it is written; lbm check says more about what is wrong with one."""
    scene = tomllib.loads((folder / "scene.toml").read_text())
    if "fluid" not in scene:
        raise ValueError("a scene without a fluid is not drawn; its plot.py draws its samples")
    if len(scene["box"]["size"]) == 3:
        raise ValueError("a box in three dimensions is not drawn; after a run, draw_slice of pictures cuts it")
    return scene


def draw(name):
    folder = CASES / name
    scene = read_scene(folder)
    unit = 1e-3 if max(scene["box"]["size"]) < 0.5 else 1.0
    label = "mm" if unit == 1e-3 else "m"
    box = np.array(scene["box"]["size"]) / unit
    width = 4.6
    figure, axes = plt.subplots(figsize=(width, np.clip(width * box[1] / box[0], 1.6, 6.5)))
    for o in scene.get("obstacle", []):
        if "diameter" in o:
            ring = o.get("hollow", False)
            axes.add_patch(plt.Circle(np.array(o["centre"]) / unit, o["diameter"] / 2 / unit, zorder=1 if ring else 2,
                                      facecolor="none" if ring else "0.6", edgecolor="0.3"))
        else:
            low, high = np.array(o["from"]) / unit, np.array(o["to"]) / unit
            axes.add_patch(plt.Rectangle(low, *(high - low), facecolor="0.6", edgecolor="0.3"))
    discs = [plt.Circle((x / unit, y / unit), d / 2 / unit) for x, y, d in discs_of(scene, folder)]
    axes.add_collection(PatchCollection(discs, facecolor="wheat", edgecolor="0.3", linewidth=0.5, zorder=2))
    draw_sides(axes, scene, box, unit)
    axes.set_aspect("equal")
    axes.set_xlim(-0.02 * box[0], 1.02 * box[0])
    axes.set_ylim(-0.02 * box[1], 1.02 * box[1])
    axes.grid(False)
    axes.set_facecolor("#eef4fb")
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.set_xlabel(f"x [{label}]", labelpad=16 if any(b["side"] == "bottom" for b in scene.get("boundary", [])) else 4)
    axes.set_ylabel(f"y [{label}]", labelpad=16 if any(b["side"] == "left" for b in scene.get("boundary", [])) else 4)
    figure.text(0.5, 1.0, drive_text(scene), ha="center", va="bottom", fontsize=8, transform=figure.transFigure)
    (folder / "pictures").mkdir(exist_ok=True)
    figure.savefig(folder / "pictures" / "setup.png", bbox_inches="tight")
    plt.close(figure)


def main():
    p = argparse.ArgumentParser(prog="tools/draw_setup", description=__doc__.splitlines()[0])
    p.add_argument("scenes", nargs="*", metavar="SCENE", help="folders of cases/")
    p.add_argument("--list", action="store_true", help="the scenes, and nothing else")
    args = p.parse_args()
    if args.list:
        print("\n".join(scenes()))
        return 0
    if not args.scenes:
        p.error("which scene? --list shows them")
    for name in args.scenes:
        if not (CASES / name / "scene.toml").exists():
            print(f"draw_setup | error | no scene '{name}'; tools/run --list shows them", file=sys.stderr)
            return 2
        try:
            draw(name)
        except (OSError, KeyError, TypeError, ValueError) as e:
            why = f"lacks {e}; build/release/bin/lbm check says what a scene needs" if isinstance(e, KeyError) else e
            print(f"draw_setup | error | {CASES / name / 'scene.toml'}: {why}", file=sys.stderr)
            return 2
        print(f"draw_setup | {CASES / name / 'pictures' / 'setup.png'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
