"""Draws who includes whom, from the sources, into lbm_solver/architecture.png; --check says whether the edges in
tools/architecture.txt, from which it was drawn, still are those of the sources."""

import argparse
import pathlib
import re
import sys

from bplbm.project import ROOT

INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"', re.M)
EDGES = ROOT / "tools" / "architecture.txt"


def room(path):
    """A room of protocol, lbm_solver or liggghts_coupling, an engine, or None."""
    parts = pathlib.PurePosixPath(path).parts
    if parts[0] == "protocol" and len(parts) > 2:
        return "protocol/replay, trace" if path.endswith("_main.cpp") else f"protocol/{parts[1]}"
    if parts[0] == "lbm_solver":
        if parts[1] in ("collision", "turbulence"):  # operators and eddy viscosity know each other
            return "lbm_solver/collision, turbulence"
        return f"lbm_solver/{parts[1]}" if len(parts) > 2 else "lbm_solver/main"
    if parts[0] == "liggghts_coupling" and len(parts) > 2:
        return f"liggghts_coupling/{parts[1]}"
    return "/".join(parts[:3]) if parts[:2] == ("tools", "engines") and len(parts) > 3 else None


def edges():
    found = set()
    for path in ROOT.glob("*/**/*"):
        name = path.relative_to(ROOT).as_posix()
        if path.suffix not in (".h", ".cpp") or name.startswith(("build", "tests")) or not room(name):
            continue
        for header in INCLUDE.findall(path.read_text()):
            if room(header) and room(header) != room(name):
                found.add((room(name), room(header)))
    return sorted(found)


def reduced(pairs):
    """Without arrows that a longer way says already."""
    def reach(a, b, seen):
        return any(y == b or (y not in seen and reach(y, b, seen | {y})) for x, y in pairs if x == a)
    return [(a, b) for a, b in pairs if not any(c != b and reach(c, b, {a, c}) for x, c in pairs if x == a)]


def draw(pairs):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    rooms = sorted({r for pair in pairs for r in pair})
    depth = {}

    def level(r, above=()):
        if r in above:
            raise SystemExit(f"check | error | rooms include each other: {' -> '.join((*above, r))}")
        if r not in depth:
            depth[r] = 1 + max((level(b, (*above, r)) for a, b in pairs if a == r), default=-1)
        return depth[r]

    place = {}
    for d in range(max(map(level, rooms)) + 1):
        row = [r for r in rooms if level(r) == d]
        for i, r in enumerate(row):
            place[r] = ((i - (len(row) - 1) / 2) * 2.6, d)
    figure, axes = plt.subplots(figsize=(11.5, 7.0))
    colors = {"protocol": "#d8e8d0", "lbm_solver": "#dfe8f5", "liggghts_coupling": "#f5e4d0", "tools": "#eee"}
    for a, b in reduced(pairs):
        (x0, y0), (x1, y1) = place[a], place[b]
        axes.annotate("", (x1, y1 + 0.2), (x0, y0 - 0.2), arrowprops={"arrowstyle": "->", "color": "0.5", "linewidth": 0.8})
    for r, (x, y) in place.items():
        axes.text(x, y, r.replace("/", "/\n", 1), ha="center", va="center", fontsize=8,
                  bbox={"boxstyle": "round,pad=0.4", "facecolor": colors[r.split("/")[0]], "edgecolor": "0.5"})
    xs = [x for x, _ in place.values()]
    axes.set_xlim(min(xs) - 1.6, max(xs) + 1.6)
    axes.set_ylim(-0.6, max(d for _, d in place.values()) + 0.6)
    axes.axis("off")
    axes.set_title("who includes whom (an arrow that a longer way says is left out)", fontsize=9)
    figure.savefig(ROOT / "lbm_solver" / "architecture.png", dpi=110, bbox_inches="tight")


def main():
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("--check", action="store_true", help="compare only")
    pairs, text = edges(), "".join(f"{a} -> {b}\n" for a, b in edges())
    if p.parse_args().check:
        if EDGES.read_text() == text:
            return 0
        print("check | error | the include graph has changed: run tools/draw_architecture.py", file=sys.stderr)
        return 1
    EDGES.write_text(text)
    draw(pairs)
    return 0

