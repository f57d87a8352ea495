"""Draws a scene's box, sides, obstacles, particles and drives, as its files describe them; three dimensions as seen along y.

    tools/draw_setup soil_erosion disc_migration

writes pictures/setup.png into the folder of the scene.
"""

import argparse
import pathlib
import re
import sys

from matplotlib.collections import LineCollection, PatchCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap
import matplotlib.pyplot as plt
import numpy as np

from bplbm import pictures  # noqa: F401  (its style)
from bplbm import shapes
from bplbm.page.setup import drawn_sides, flat_box, flat_origin, on_paper, stretch
from bplbm.project import INSTALLED, tool
from bplbm.reading import read_table
from bplbm.scene_words import COLOR, drive_text, motion_text, side_line, words
from bplbm.scenes import Unknown, find, scenes

GREYS = LinearSegmentedColormap.from_list("solid", ["#eef4fb", "0.5"])  # from fluid to solid
ATOM = re.compile(r"create_atoms\s+\d+\s+single\s+(\S+)\s+(\S+)\s+(\S+)")
DIAMETER = re.compile(r"set\s+atom\s+(\d+)\s+diameter\s+(\S+)")


def script_discs(folder, up):
    """Discs or spheres x, y or z (up), diameter [m] that the scene's script creates with plain numbers, file by file."""
    discs = []
    for path in sorted(folder.glob("*.liggghts")):
        text = path.read_text()
        places = [(float(atom[0]), float(atom[up])) for atom in ATOM.findall(text) if "$" not in "".join(atom)]
        diameters = {int(i): float(d) for i, d in DIAMETER.findall(text) if "$" not in d}
        if diameters:
            discs += [(x, y, diameters[i + 1]) for i, (x, y) in enumerate(places)]
        elif places:
            gaps = np.linalg.norm(np.diff(places, axis=0), axis=1)
            discs += [(x, y, gaps.min()) for x, y in places]  # grains in a row touch
    return discs


def discs_of(scene, folder):
    p, up = scene.get("particles", {}), len(scene["box"]["size"]) - 1
    discs = [(place[0], place[up], np.max(p["diameter"])) for place in p.get("start", [])] if p else []
    if "grains" in scene:
        table = read_table(folder / scene["grains"]["file"])
        discs += list(zip(table["x"], table["xyz"[up]], table["diameter"]))
    return discs + script_discs(folder, up)


def draw_sides(axes, scene, box, origin, unit):
    def line(side, low, high):
        return (np.array(ends) + begin for ends, begin in zip(side_line(side, box, low, high), origin))

    for key, sides in drawn_sides(scene).items():
        periodic = scene["box"].get(key, "wall") == "periodic"
        for side in map(on_paper, sides):
            x, y = line(side, 0, box[1] if side in ("left", "right") else box[0])
            axes.plot(x, y, "--" if periodic else "-", color="0.55" if periodic else "k", linewidth=1 if periodic else 2.5,
                      solid_capstyle="projecting", zorder=3)
    offsets = {"left": (-30, 0, "right"), "right": (6, 0, "left"), "bottom": (0, -32, "center"), "top": (0, 6, "center")}
    for b in scene.get("boundary", []):
        if len(scene["box"]["size"]) == 3 and b["side"] in ("bottom", "top"):
            continue  # they face the reader
        side, (low, high) = on_paper(b["side"]), stretch(b, scene)
        x, y = line(side, low / unit, high / unit)
        axes.plot(x, y, color=COLOR[b["kind"]], linewidth=5, solid_capstyle="butt", zorder=4)
        dx, dy, align = offsets[side]
        axes.annotate(words(b), (np.mean(x), np.mean(y)), xytext=(dx, dy), textcoords="offset points", ha=align,
                      va="center" if dx else "bottom", color=COLOR[b["kind"]], rotation=90 if dx else 0)


def draw_obstacle(axes, o, scene, folder, unit):
    up = len(scene["box"]["size"]) - 1
    flat = [0, up]
    if "diameter" in o and "from" in o:  # a cylinder, as a strip; one that points at the reader as a disc
        ends, radius = np.array([o["from"], o["to"]])[:, flat] / unit, o["diameter"] / 2 / unit
        along = ends[1] - ends[0]
        if not np.any(along):
            axes.add_patch(plt.Circle(ends[0], radius, facecolor="0.6", edgecolor="0.3", alpha=0.8))
        else:
            across = radius * np.array([-along[1], along[0]]) / np.linalg.norm(along)
            axes.add_patch(plt.Polygon([ends[0] - across, ends[1] - across, ends[1] + across, ends[0] + across],
                                       facecolor="0.6", edgecolor="0.3", alpha=0.8))
    elif "diameter" in o:
        ring = o.get("hollow", False)
        axes.add_patch(plt.Circle(np.array(o["centre"])[flat] / unit, o["diameter"] / 2 / unit, zorder=1 if ring else 2,
                                  facecolor="none" if ring else "0.6", edgecolor="0.3"))
    elif "image" in o:
        parts = shapes.solid_fraction(o, folder)
        x0, x1, *_, y0, y1 = np.array(shapes.image_extent(o, parts, scene["box"].get("origin", [0.0] * (up + 1)))) / unit
        parts = parts if parts.ndim == 2 else parts.max(axis=1)  # the most solid voxel along y
        axes.imshow(np.where(parts > 0, parts, np.nan), origin="lower", extent=(x0, x1, y0, y1), cmap=GREYS, vmin=0, vmax=1,
                    interpolation="nearest", zorder=1)
    elif "mesh" in o:
        corners = shapes.placed_mesh(o, folder)
        middle = scene["box"].get("origin", [0.0] * 3)[1] + 0.5 * scene["box"]["size"][1]
        cut = shapes.section(corners, middle)[:, :, flat] / unit  # shows what is hollow
        axes.add_collection(PolyCollection(shapes.facing(corners)[:, :, flat] / unit, facecolor="0.6", edgecolor="0.4",
                                           linewidth=0.3, alpha=0.25 if len(cut) else 0.8, zorder=2))
        axes.add_collection(LineCollection(cut, colors="0.25", linewidths=1.5, zorder=2))
    else:
        low, high = np.array(o["from"])[flat] / unit, np.array(o["to"])[flat] / unit
        axes.add_patch(plt.Rectangle(low, *(high - low), facecolor="0.6", edgecolor="0.3"))
    if text := motion_text(o, up + 1):
        start, size = np.array(flat_origin(scene)), flat_box(scene)
        low, high = (np.clip(corner[flat], start, start + size) / unit for corner in shapes.extent(o, folder))
        hollow = o.get("hollow", False)
        axes.annotate(text, (0.5 * (low[0] + high[0]), high[1] if hollow else 0.5 * (low[1] + high[1])), xytext=(0, 3 if hollow else 0),
                      textcoords="offset points", ha="center", va="bottom" if hollow else "center", zorder=5, fontsize=8)


def checked(tables):
    """Tables of a scene that can be drawn; lbm check says more about what is wrong with one."""
    if "fluid" not in tables:
        raise ValueError("a scene without a fluid is not drawn; its plot.py draws its samples")
    return tables


def figure_of(scene, folder):
    """A figure of a scene's tables; files that they name lie in the folder."""
    unit = 1e-3 if max(scene["box"]["size"]) < 0.5 else 1.0
    label = "mm" if unit == 1e-3 else "m"
    box, origin = np.array(flat_box(scene)) / unit, np.array(flat_origin(scene)) / unit
    up = "xyz"[len(scene["box"]["size"]) - 1]
    width = 4.6
    figure, axes = plt.subplots(figsize=(width, np.clip(width * box[1] / box[0], 1.6, 6.5)))
    for o in scene.get("obstacle", []):
        draw_obstacle(axes, o, scene, folder, unit)
    for artist in [*axes.patches, *axes.collections, *axes.images]:
        artist.set_clip_path(plt.Rectangle(origin, *box, transform=axes.transData))
    discs = [plt.Circle((x / unit, y / unit), d / 2 / unit) for x, y, d in discs_of(scene, folder)]
    axes.add_collection(PatchCollection(discs, facecolor="wheat", edgecolor="0.3", linewidth=0.5, zorder=2))
    draw_sides(axes, scene, box, origin, unit)
    axes.set_aspect("equal")
    for limit, low, length in zip((axes.set_xlim, axes.set_ylim), origin, box):
        limit(low - 0.02 * length, low + 1.02 * length)
    axes.grid(False)
    axes.set_facecolor("#eef4fb")
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.set_xlabel(f"x [{label}]", labelpad=16 if any(on_paper(b["side"]) == "bottom" for b in scene.get("boundary", [])) else 4)
    axes.set_ylabel(f"{up} [{label}]", labelpad=16 if any(b["side"] == "left" for b in scene.get("boundary", [])) else 4)
    above = 24 if any(on_paper(b["side"]) == "top" for b in scene.get("boundary", [])) else 10  # points: words of a boundary
    axes.annotate(drive_text(scene), (0.5, 1.0), xycoords="axes fraction", xytext=(0, above), textcoords="offset points",
                  ha="center", va="bottom", fontsize=8)
    return figure


def draw(scene):
    """Writes the picture of a Scene into its folder, of an installed one into the current folder. Returns its path."""
    figure = figure_of(checked(scene.tables()), scene.folder)
    mine = not (INSTALLED and scene.shipped)
    path = scene.folder / "pictures" / "setup.png" if mine else pathlib.Path.cwd() / f"{scene.name}-setup.png"
    path.parent.mkdir(exist_ok=True)
    figure.savefig(path, bbox_inches="tight")
    plt.close(figure)
    return path


def main():
    p = argparse.ArgumentParser(prog=tool("draw_setup"), description=__doc__.splitlines()[0])
    p.add_argument("scenes", nargs="*", metavar="SCENE", help="names of cases/, or paths of scenes")
    p.add_argument("--list", action="store_true", help="the scenes, and nothing else")
    args = p.parse_args()
    if args.list:
        print("\n".join(scenes()))
        return 0
    if not args.scenes:
        p.error("which scene? --list shows them")
    for name in args.scenes:
        try:
            scene = find(name)
        except Unknown as unknown:
            print(f"draw_setup | error | {unknown}", file=sys.stderr)
            return 2
        try:
            picture = draw(scene)
        except (OSError, KeyError, TypeError, ValueError) as e:
            look = f"{'bplbm' if INSTALLED else 'build/release/bin/lbm'} check"
            why = f"lacks {e}; {look} says what a scene needs" if isinstance(e, KeyError) else e
            print(f"draw_setup | error | {scene.file}: {why}", file=sys.stderr)
            return 2
        print(f"draw_setup | {picture}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
