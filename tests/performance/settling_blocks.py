"""A packing that settles through a box on two ranks of the fluid: equal blocks, blocks of equal work at the start, and cut
anew as it sinks, in turns.

    settling_blocks.py [--rounds 3] [--dimension 2 3] [--fluid-ranks 2]

Discs or spheres of ten cells begin in the upper third of a closed box and end on its floor. Prints wall time, that of the
busiest rank over the mean, and the moves, each the median of the rounds.
"""

import argparse
import json
import pathlib
import shutil
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))

from bplbm.mpi_job import environment  # noqa: E402
from bplbm.project import BIN, CASES, home  # noqa: E402

CELL, DIAMETER = 1e-3, 1e-2  # [m]
BOXES = {2: ([360, 720], 24.0), 3: ([72, 72, 216], 7.0)}  # cells along each axis, and seconds until the bed lies
BLOCKS = {"equal blocks": 'blocks = "equal"', "of equal work at the start": 'blocks = "equal_work"\nwaiting_bound = 1',
          "cut anew": 'blocks = "equal_work"'}

SCENE = """title = "settling"
[box]
size = {size}
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = {gravity}
velocity_scale = 0.12
[particles]
diameter = {diameter}
density = 1400.0
contact_stiffness = 200.0
start = {start}
[particles.variables]
damping_ratio = 0.5
[numerics]
cell = {cell}
{blocks}
[coupling]
timeout = 300.0
[run]
end_time = {end}
[output]
probe_particles = [1]
probe_every = {end}
"""


def centres(cells):
    """In the upper third, eleven cells from each other, each a little off."""
    pitch, axes = 11.5, len(cells)
    counts = [int((n - 2) / pitch) for n in cells[:-1]] + [int(cells[-1] / 3 / pitch)]
    total = 1
    for count in counts:
        total *= count
    places = []
    for i in range(total):
        site, rest = [], i
        for count in counts:
            site.append(rest % count)
            rest //= count
        off = 0.5 * ((0.618 * i) % 1.0 - 0.5)
        place = [1 + pitch * (k + 0.5) + off for k in site]
        place[-1] = cells[-1] - place[-1]
        places.append([round(CELL * x, 9) for x in place[:axes]])
    return places


def write(folder, dimension, blocks):
    cells, end = BOXES[dimension]
    start = centres(cells)
    (folder / "scene.toml").write_text(SCENE.format(
        size=[round(CELL * n, 9) for n in cells], gravity=[0.0] * (dimension - 1) + [-0.4], diameter=DIAMETER, start=start,
        cell=CELL, end=end, blocks=blocks))
    atoms = "".join(f"create_atoms 1 single {' '.join(map(str, x))}{' 0.0' if dimension == 2 else ''} units box\n" for x in start)
    common = CASES / "common"
    (folder / "in.liggghts").write_text((common / "box.liggghts").read_text() + atoms + (
        common / f"{'discs' if dimension == 2 else 'spheres'}.liggghts").read_text())
    return len(start)


def run(folder, dimension, blocks, args):
    """@return number of bodies and the summary"""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    count = write(folder, dimension, blocks)
    line = ["mpirun", "--bind-to", "none", "--oversubscribe", "-np", str(args.fluid_ranks), str(BIN / "lbm"), "scene.toml",
            "--progress", "none", *(["--until", str(args.until)] if args.until else []), ":", "-np", "1", str(BIN / "liggghts"),
            "-in", "in.liggghts", "-log", "none", "-screen", "none"]
    job = subprocess.run(line, cwd=folder, env=environment(shared=True), check=False, capture_output=True, text=True,
                         timeout=3000)
    if job.returncode:
        sys.exit(job.stdout + job.stderr)
    return count, json.loads((folder / "out" / "summary.json").read_text())


def told(dimension, name, runs, first):
    """A line of a kind of blocks. @param first  seconds with equal blocks, in the same rounds"""
    summaries = [summary for _, summary in runs]
    walls = [s["wall_seconds"] for s in summaries]
    ratio = statistics.median([a / b for a, b in zip(first, walls)])
    busiest, moves = (statistics.median([s[key] for s in summaries]) for key in ("busiest_rank", "block_moves"))
    share = 100 * statistics.median([s["time_share"].get("balance", 0.0) for s in summaries])
    return (f"{dimension}D, {runs[0][0]} bodies, {summaries[0]['steps']} steps, {name}: {statistics.median(walls):.4g} s "
            f"({min(walls):.4g} … {max(walls):.4g}), {ratio:.3f} times as fast as equal blocks; busiest {busiest:.2f} × the "
            f"mean; {moves} moves, {share:.2g} % of the time")


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--rounds", type=int, default=3)
    p.add_argument("--dimension", type=int, nargs="+", default=[2, 3], choices=[2, 3])
    p.add_argument("--fluid-ranks", type=int, default=2)
    p.add_argument("--until", type=float)
    args = p.parse_args()
    for dimension in args.dimension:
        found = {name: [] for name in BLOCKS}
        for _ in range(args.rounds):
            for name, blocks in BLOCKS.items():
                found[name].append(run(home() / "out" / "settling_blocks", dimension, blocks, args))
        first = [summary["wall_seconds"] for _, summary in found["equal blocks"]]
        for name, runs in found.items():
            print(told(dimension, name, runs, first), flush=True)


if __name__ == "__main__":
    main()
