"""A dense, polydisperse packing of discs in a box, periodic or walled, relaxed with LIGGGHTS.

Discs of the wished sizes start at random places, repel each other and the walls, and are slowed until
none overlaps by more than the bound. Written are

  NAME.liggghts   create_atoms and set lines, to be included after create_box: LIGGGHTS reads them
                  without the traps of write_data and insert/pack in two dimensions. Uses the script's
                  variable disc_density (density × depth)
  NAME.csv        x,y,diameter in m, also usable as [grains] of a scene
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from bplbm.mpi_job import environment
from bplbm.project import BIN, tool

DENSITY, STEP_PART = 1000.0, 0.1
ROUNDS, STEPS = 60, 2000
JAMMED = 0.86  # area fraction beyond which no packing of discs relaxes


def fail(text):
    print(f"packing | error | {text}", file=sys.stderr)
    sys.exit(2)


def arguments():
    p = argparse.ArgumentParser(prog=tool("make_packing"), description=__doc__,
                                formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--out", required=True, metavar="NAME", help="files NAME.liggghts and NAME.csv")
    p.add_argument("--box", required=True, nargs=4, type=float, metavar=("X_LO", "X_HI", "Y_LO", "Y_HI"),
                   help="[m]")
    p.add_argument("--diameter", required=True, nargs=2, type=float, metavar=("SMALLEST", "LARGEST"),
                   help="[m]")
    p.add_argument("--law", default="uniform", choices=["uniform", "lognormal"],
                   help="of the diameters; lognormal: ± 2 σ between the two, cut off there")
    group = p.add_mutually_exclusive_group()
    group.add_argument("--count", type=int, help="number of discs")
    group.add_argument("--fraction", type=float, default=0.80, help="area fraction of the box; default 0.80")
    p.add_argument("--periodic", default="", choices=["", "x", "y", "xy"], help="periodic directions")
    p.add_argument("--overlap", type=float, default=1e-3, help="largest overlap over the smaller radius")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--look", action="store_true", help=argparse.SUPPRESS)  # at the arguments, and go
    return p.parse_args()


def diameters(args, random):
    """Sizes [m] by the law: as many as were asked for, or as fill the fraction."""
    lo, hi = args.diameter
    if not 0 < lo <= hi:
        fail(f"--diameter {lo} {hi}: give the smallest and the largest, both positive")
    if not np.all(np.isfinite([*args.box, lo, hi, args.fraction, args.overlap])):
        fail("--box, --diameter, --fraction and --overlap are finite numbers")
    if (args.count is not None and args.count < 1) or not args.fraction > 0 or not args.overlap > 0:
        fail("--count is a whole number of at least 1, --fraction and --overlap are positive")
    area = (args.box[1] - args.box[0]) * (args.box[3] - args.box[2])
    if not area > 0 or args.box[1] <= args.box[0]:
        fail("--box: give X_LO X_HI Y_LO Y_HI with X_LO < X_HI and Y_LO < Y_HI")

    def draw():
        if args.law == "uniform" or lo == hi:
            return random.uniform(lo, hi)
        middle, sigma = 0.5 * np.log(lo * hi), 0.25 * np.log(hi / lo)
        while True:
            d = np.exp(random.normal(middle, sigma))
            if lo <= d <= hi:
                return d

    sizes, filled = [], 0.0
    while len(sizes) < args.count if args.count else filled < args.fraction * area:
        sizes.append(draw())
        filled += np.pi / 4 * sizes[-1] ** 2
    if filled > JAMMED * area:
        fail(f"{len(sizes)} discs fill {filled / area:.2f} of the box; above {JAMMED} they cannot all fit: "
             "take fewer or smaller ones")
    return np.array(sizes)


def script(args, places, sizes):
    """LIGGGHTS' input: soft, heavily damped repulsion, in rounds that each end with a dump."""
    x_lo, x_hi, y_lo, y_hi = args.box
    mass = DENSITY * np.pi / 4 * sizes.min() ** 2
    stiffness = 1e5
    step = STEP_PART * np.sqrt(mass / stiffness)
    damping = 2 * 0.3 * np.sqrt(stiffness / mass)
    side = {axis: "p" if axis in args.periodic else "f" for axis in "xy"}
    discs = "\n".join(f"create_atoms 1 single {x:.17g} {y:.17g} 0.0 units box" for x, y in places)
    sets = "\n".join(f"set atom {i + 1} diameter {d:.17g} density {DENSITY}" for i, d in enumerate(sizes))
    walls = "".join(
        f"fix {axis}{k} all wall/gran model hooke/stiffness primitive type 1 {axis}plane {at:.17g}\n"
        for axis, ends in (("x", (x_lo, x_hi)), ("y", (y_lo, y_hi))) if side[axis] == "f"
        for k, at in enumerate(ends))
    properties = "".join(f"fix {name} all property/global {name} peratomtypepair 1 {value:.17g}\n"
                         for name, value in (("kn", stiffness), ("kt", 0.0), ("gamman", damping),
                                             ("gammat", 0.0), ("coefficientFriction", 0.0)))
    return f"""dimension 2
units si
atom_style granular
atom_modify map array
boundary {side['x']} {side['y']} p
newton off
communicate single vel yes
region box block {x_lo:.17g} {x_hi:.17g} {y_lo:.17g} {y_hi:.17g} -0.5 0.5 units box
create_box 1 box
neighbor {0.2 * sizes.max():.17g} bin
neigh_modify delay 0
{discs}
{sets}
{properties}pair_style gran model hooke/stiffness
pair_coeff * *
{walls}fix move all nve/limit radius_ratio 0.02
fix slow all viscous {0.05 * mass / step:.17g}
fix flat all enforce2d
timestep {step:.17g}
thermo {STEPS}
dump places all custom {STEPS} places.*.txt id x y
dump_modify places sort id format "%d %.17g %.17g"
"""


def separations(places, sizes, args):
    """Largest overlap over the smaller radius, of discs with each other and with the walls."""
    x_lo, x_hi, y_lo, y_hi = args.box
    length = np.array([x_hi - x_lo, y_hi - y_lo])
    worst = 0.0
    for i in range(len(places) - 1):
        apart = places[i + 1:] - places[i]
        for axis in (0, 1):
            if "xy"[axis] in args.periodic:
                apart[:, axis] -= length[axis] * np.round(apart[:, axis] / length[axis])
        overlap = 0.5 * (sizes[i] + sizes[i + 1:]) - np.hypot(apart[:, 0], apart[:, 1])
        worst = max(worst, (overlap / (0.5 * np.minimum(sizes[i], sizes[i + 1:]))).max())
    for axis, (lo, hi) in enumerate(((x_lo, x_hi), (y_lo, y_hi))):
        if "xy"[axis] not in args.periodic:
            out = np.maximum(lo + 0.5 * sizes - places[:, axis], places[:, axis] + 0.5 * sizes - hi)
            worst = max(worst, (out / (0.5 * sizes)).max())
    return worst


def relax(args, places, sizes):
    """Runs LIGGGHTS until the overlaps are within the bound. Returns places and what is left."""
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(ROUNDS // 10):
            text = script(args, places, sizes) + f"run {10 * STEPS}\n"
            pathlib.Path(folder, "in.packing").write_text(text)
            job = subprocess.run([BIN / "liggghts", "-in", "in.packing", "-screen", "none"], cwd=folder, env=environment(1),
                                 check=False, capture_output=True, text=True)
            if job.returncode:
                fail(f"LIGGGHTS stopped:\n{job.stdout}{job.stderr}")
            for k in range(1, 11):
                file = pathlib.Path(folder, f"places.{k * STEPS}.txt")
                rows = np.loadtxt(file, skiprows=9, ndmin=2)
                if len(rows) != len(sizes):
                    fail(f"{len(sizes) - len(rows)} discs left the box; take another seed or a lower fraction")
                places = wrap(rows[:, 1:3], args)
                left = separations(places, sizes, args)
                if left <= args.overlap:
                    return places, left
    return places, left


def wrap(places, args):
    """Back into the box through periodic sides."""
    lo = np.array([args.box[0], args.box[2]])
    length = np.array([args.box[1], args.box[3]]) - lo
    for axis in (0, 1):
        if "xy"[axis] in args.periodic:
            places[:, axis] = lo[axis] + (places[:, axis] - lo[axis]) % length[axis]
    return places


MADE_BY = "discs; made by tools/make_packing"


def refuse_others(args):
    """A mistyped name costs no file that is no packing."""
    for ending, ours in ((".liggghts", MADE_BY), (".csv", "x,y,diameter")):
        path = pathlib.Path(args.out + ending)
        if not path.exists():
            continue
        if path.is_file():
            with open(path, errors="replace") as file:
                if ours in file.readline(10000):
                    continue
        fail(f"{path} is there and no packing of this tool: it is not overwritten; give another --out, or remove it")


def write(args, places, sizes):
    lines = [f"# {len(sizes)} {MADE_BY} {' '.join(sys.argv[1:])}"]
    for i, ((x, y), d) in enumerate(zip(places, sizes)):
        lines.append(f"create_atoms 1 single {x:.9g} {y:.9g} 0.0 units box")
        lines.append(f"set atom {i + 1} diameter {d:.9g} density ${{disc_density}}")
    pathlib.Path(args.out + ".liggghts").write_text("\n".join(lines) + "\n")
    rows = [f"{x:.9g},{y:.9g},{d:.9g}" for (x, y), d in zip(places, sizes)]
    pathlib.Path(args.out + ".csv").write_text("\n".join(["x,y,diameter", *rows]) + "\n")


def main():
    args = arguments()
    if args.seed < 0:
        fail("--seed is a whole number of at least 0")
    refuse_others(args)
    random = np.random.default_rng(args.seed)
    sizes = diameters(args, random)
    if args.look:
        return
    margin = 0.5 * sizes
    low = np.array([args.box[0], args.box[2]])
    high = np.array([args.box[1], args.box[3]])
    places = random.uniform(low + margin[:, None], high - margin[:, None])
    places, left = relax(args, places, sizes)
    area = np.prod(high - low)
    fraction = np.pi / 4 * (sizes**2).sum() / area
    if left > args.overlap:
        fail(f"overlaps of {left:.2g} radii are left at an area fraction of {fraction:.3f}; take a lower "
             "fraction or a larger --overlap")
    write(args, places, sizes)
    print(f"packing | {len(sizes)} discs, area fraction {fraction:.3f}, largest overlap {max(left, 0):.2g} radii "
          f"-> {args.out}.liggghts, {args.out}.csv")


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        print("packing | stopped: interrupted by Ctrl-C", file=sys.stderr)
        sys.exit(1)
    except OSError as error:
        fail(f"{error.filename}: {error.strerror}; give another --out, in a folder that exists")
