"""A dense, polydisperse packing of discs, spheres, or clumps of them, in a box, periodic or walled.

Discs or spheres of the wished sizes start at random places, repel each other and the walls, and are slowed by LIGGGHTS
until none overlaps by more than the bound. With --clump they are bodies of one shape, which start at random angles, too,
and are moved here. Written are

  NAME.liggghts   create_atoms and set lines, to be included after create_box: LIGGGHTS reads them
                  without the traps of write_data and insert/pack in two dimensions. Uses the script's
                  variable disc_density (density × depth), for spheres density_max
  NAME.csv        x,y,diameter (x,y,z,diameter) in m, also usable as [grains] of a scene

Of clumps these are all their spheres, each with the number of its clump as molecule; NAME.liggghts begins with what its
script needs besides.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from bplbm import clump_packing
from bplbm.mpi_job import environment
from bplbm.project import BIN, tool

DENSITY, STEP_PART = 1000.0, 0.1
ROUNDS, STEPS = 60, 2000
JAMMED = {2: 0.86, 3: 0.66}  # fraction of the box beyond which no packing relaxes
USUAL = {2: 0.80, 3: 0.55}
BALL = {2: np.pi / 4, 3: np.pi / 6}  # of a diameter of 1


def dimensions(args):
    return len(args.box) // 2


def ends(args):
    """Lower and upper corner of the box [m]."""
    return np.array(args.box[::2]), np.array(args.box[1::2])


def kind(args):
    return "clumps" if args.clump else "discs" if dimensions(args) == 2 else "spheres"


def fail(text):
    print(f"packing | error | {text}", file=sys.stderr)
    sys.exit(2)


def arguments():
    p = argparse.ArgumentParser(prog=tool("make_packing"), description=__doc__,
                                formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--out", required=True, metavar="NAME", help="files NAME.liggghts and NAME.csv")
    p.add_argument("--box", required=True, nargs="+", type=float, metavar="LO HI",
                   help="X_LO X_HI Y_LO Y_HI of discs, with Z_LO Z_HI of spheres [m]")
    p.add_argument("--diameter", required=True, nargs=2, type=float, metavar=("SMALLEST", "LARGEST"),
                   help="[m]; of clumps: of the disc or sphere of their area or volume")
    p.add_argument("--clump", metavar="FILE", help="makes clumps of this shape: lines of x y z radius in any unit, as "
                   f"{tool('make_clump')} writes them; z = 0 for discs")
    p.add_argument("--law", default="uniform", choices=["uniform", "lognormal"],
                   help="of the diameters; lognormal: ± 2 σ between the two, cut off there")
    group = p.add_mutually_exclusive_group()
    group.add_argument("--count", type=int, help="number of discs or spheres")
    group.add_argument("--fraction", type=float, help="of the box that they fill; default 0.80, of spheres 0.55")
    p.add_argument("--periodic", default="", choices=["", "x", "y", "z", "xy", "xz", "yz", "xyz"], help="periodic directions")
    p.add_argument("--overlap", type=float, default=1e-3, help="largest overlap over the smaller radius")
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--force", action="store_true", help="replace an earlier packing of that name")
    p.add_argument("--look", action="store_true", help=argparse.SUPPRESS)  # at the arguments, and go
    args = p.parse_args()
    if len(args.box) not in (4, 6):
        fail("--box: give X_LO X_HI Y_LO Y_HI, of spheres also Z_LO Z_HI")
    if "z" in args.periodic and dimensions(args) == 2:
        fail("--periodic z: a box of discs has no z; give six numbers as --box for spheres")
    if args.clump:
        try:
            clump_packing.read_shape(args.clump, dimensions(args))
        except ValueError as error:
            fail(str(error))
    args.fraction = USUAL[dimensions(args)] if args.fraction is None else args.fraction
    return args


def diameters(args, random):
    """Sizes [m] by the law: as many as were asked for, or as fill the fraction."""
    lo, hi = args.diameter
    if not 0 < lo <= hi:
        fail(f"--diameter {lo} {hi}: give the smallest and the largest, both positive")
    if not np.all(np.isfinite([*args.box, lo, hi, args.fraction, args.overlap])):
        fail("--box, --diameter, --fraction and --overlap are finite numbers")
    if (args.count is not None and args.count < 1) or not args.fraction > 0 or not args.overlap > 0:
        fail("--count is a whole number of at least 1, --fraction and --overlap are positive")
    low, high = ends(args)
    if not np.all(low < high):
        fail("--box: give X_LO X_HI Y_LO Y_HI with X_LO < X_HI and Y_LO < Y_HI")
    room, d = np.prod(high - low), dimensions(args)

    def draw():
        if args.law == "uniform" or lo == hi:
            return random.uniform(lo, hi)
        middle, sigma = 0.5 * np.log(lo * hi), 0.25 * np.log(hi / lo)
        while True:
            size = np.exp(random.normal(middle, sigma))
            if lo <= size <= hi:
                return size

    sizes, filled = [], 0.0
    while len(sizes) < args.count if args.count else filled < args.fraction * room:
        sizes.append(draw())
        filled += BALL[d] * sizes[-1] ** d
    if filled > JAMMED[d] * room:
        fail(f"{len(sizes)} {kind(args)} fill {filled / room:.2f} of the box; above {JAMMED[d]} they cannot all fit: "
             "take fewer or smaller ones")
    return np.array(sizes)


def script(args, places, sizes):
    """LIGGGHTS' input: soft, heavily damped repulsion, in rounds that each end with a dump."""
    d, (low, high) = dimensions(args), ends(args)
    mass = DENSITY * BALL[d] * sizes.min() ** d
    stiffness = 1e5
    step = STEP_PART * np.sqrt(mass / stiffness)
    damping = 2 * 0.3 * np.sqrt(stiffness / mass)
    side = {axis: "p" if axis in args.periodic or (axis == "z" and d == 2) else "f" for axis in "xyz"}
    grains = "\n".join("create_atoms 1 single " + " ".join(f"{v:.17g}" for v in [*place, 0.0][:3]) + " units box" for place in places)
    sets = "\n".join(f"set atom {i + 1} diameter {size:.17g} density {DENSITY}" for i, size in enumerate(sizes))
    box = " ".join(f"{lo:.17g} {hi:.17g}" for lo, hi in [*zip(low, high, strict=True), *([(-0.5, 0.5)] if d == 2 else [])])
    walls = "".join(
        f"fix {axis}{k} all wall/gran model hooke/stiffness primitive type 1 {axis}plane {at:.17g}\n"
        for axis, lo, hi in zip("xyz", low, high, strict=False) if side[axis] == "f" for k, at in enumerate((lo, hi)))
    properties = "".join(f"fix {name} all property/global {name} peratomtypepair 1 {value:.17g}\n"
                         for name, value in (("kn", stiffness), ("kt", 0.0), ("gamman", damping),
                                             ("gammat", 0.0), ("coefficientFriction", 0.0)))
    return f"""dimension {d}
units si
atom_style granular
atom_modify map array
boundary {side['x']} {side['y']} {side['z']}
newton off
communicate single vel yes
region box block {box} units box
create_box 1 box
neighbor {0.2 * sizes.max():.17g} bin
neigh_modify delay 0
{grains}
{sets}
{properties}pair_style gran model hooke/stiffness
pair_coeff * *
{walls}fix move all nve/limit radius_ratio 0.02
fix slow all viscous {0.05 * mass / step:.17g}
{"fix flat all enforce2d" if d == 2 else ""}
timestep {step:.17g}
thermo {STEPS}
dump places all custom {STEPS} places.*.txt id x y z
dump_modify places sort id format "%d %.17g %.17g %.17g"
"""


def separations(places, sizes, args):
    """Largest overlap over the smaller radius, of grains with each other and with the walls."""
    low, high = ends(args)
    length, worst = high - low, 0.0
    periodic = np.array([axis in args.periodic for axis in "xyz"[:len(low)]])
    for i in range(len(places) - 1):
        apart = places[i + 1:] - places[i]
        apart -= periodic * length * np.round(apart / length)
        overlap = 0.5 * (sizes[i] + sizes[i + 1:]) - np.linalg.norm(apart, axis=1)
        worst = max(worst, (overlap / (0.5 * np.minimum(sizes[i], sizes[i + 1:]))).max())
    for axis in np.flatnonzero(~periodic):
        out = np.maximum(low[axis] + 0.5 * sizes - places[:, axis], places[:, axis] + 0.5 * sizes - high[axis])
        worst = max(worst, (out / (0.5 * sizes)).max())
    return worst


def relax(args, places, sizes):
    """Runs LIGGGHTS until the overlaps are within the bound. Returns places and what is left."""
    with tempfile.TemporaryDirectory() as folder:
        for number in range(1, ROUNDS // 10 + 1):
            text = script(args, places, sizes) + f"run {10 * STEPS}\n"
            pathlib.Path(folder, "in.packing").write_text(text)
            job = subprocess.run([BIN / "liggghts", "-in", "in.packing", "-screen", "none"], cwd=folder, env=environment(shared=False),
                                 check=False, capture_output=True, text=True)
            if job.returncode:
                fail(f"LIGGGHTS stopped:\n{job.stdout}{job.stderr}")
            for k in range(1, 11):
                file = pathlib.Path(folder, f"places.{k * STEPS}.txt")
                rows = np.loadtxt(file, skiprows=9, ndmin=2)
                if len(rows) != len(sizes):
                    fail(f"{len(sizes) - len(rows)} {kind(args)} left the box; take another seed or a lower fraction")
                places = wrap(rows[:, 1:1 + dimensions(args)], args)
                left = separations(places, sizes, args)
                if left <= args.overlap:
                    return places, left
            print(f"packing | round {number} of at most {ROUNDS // 10}: the largest overlap is {left:.2g} radii", flush=True)
    return places, left


def wrap(places, args):
    """Back into the box through periodic sides."""
    low, high = ends(args)
    for axis, name in enumerate("xyz"[:len(low)]):
        if name in args.periodic:
            places[:, axis] = low[axis] + (places[:, axis] - low[axis]) % (high[axis] - low[axis])
    return places


def pack_clumps(args, sizes, random):
    low, high = ends(args)
    periodic = np.array([axis in args.periodic for axis in "xyz"[:len(low)]])
    try:
        return clump_packing.pack(args.clump, sizes, low, high, periodic, args.overlap, random)
    except ValueError as error:
        fail(str(error))


MADE_BY = f"; made by {tool('make_packing')}"
OURS = ("; made by tools/make_packing", "; made by bplbm make_packing")
OF_NEW = ("; made by tools/new.", "; made by bplbm new.")  # the loose grains of a new scene


def words_of(line):
    """The command line that the first line of a packing holds."""
    return next((line.partition(ours)[2].strip() for ours in OURS if ours in line), "")


def own_words():
    """This command line as a packing holds it: --force makes no other packing."""
    return " ".join(word for word in sys.argv[1:] if word != "--force")


def first_line(path):
    """Of a file that may be anything; none of a folder."""
    if not path.is_file():
        return ""
    with open(path, errors="replace") as file:
        return file.readline(10000)


def refuse_others(args):
    """A name costs no file that is no packing, and no other packing without --force. The same command makes the same one."""
    script, table = (pathlib.Path(args.out + ending) for ending in (".liggghts", ".csv"))
    for path, ours in ((script, (*OURS, *OF_NEW)), (table, ("x,y,",))):
        if path.exists() and not any(word in first_line(path) for word in ours):
            fail(f"{path} is there and no packing of this tool: it is not overwritten; give another --out, or remove it")
    if args.force:
        return
    line = first_line(script)
    if any(word in line for word in OF_NEW):
        fail(f"{script} holds the grains that {tool('new')} made; --force replaces them, or give another --out")
    if line and words_of(line) != own_words():
        fail(f"{script} holds another packing, made with {words_of(line)}; give another --out, or --force to replace it")
    if table.exists() and not line:
        fail(f"{table} is there without {script.name}; give another --out, or --force to replace it")


def make_folder(args):
    """Of the files, before anything is computed."""
    folder = pathlib.Path(args.out).parent
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        fail(f"{folder}: {error.strerror}; give another --out")
    if not os.access(folder, os.W_OK):
        fail(f"{folder}: this folder cannot be written to; give another --out")


HOW_CLUMPS_MOVE = """# Spheres of a clump have its number as molecule. A script with them has, in this order,
#   atom_style hybrid granular molecular
#   include THIS FILE, after create_box
#   neigh_modify exclude molecule all
#   fix move all rigid molecule
"""


def numbers(values):
    return " ".join(f"{v:.9g}" if v else "0.0" for v in values)


def write(args, places, sizes, clumps=None, excess=1.0):
    """clumps: of each sphere the number of its clump and how many times it was moved through each periodic side.
    excess: of the volumes of a clump's spheres over its own, by which their density is divided."""
    density = "${disc_density}" if dimensions(args) == 2 else "${density_max}"
    count = f"{clumps[0][-1]} clumps of {len(sizes) // clumps[0][-1]}" if clumps else f"{len(sizes)} {kind(args)}"
    lines = [f"# {count}{MADE_BY} {own_words()}"]
    if clumps:
        lines += [*HOW_CLUMPS_MOVE.splitlines(), f"variable clump_density equal {density}/{excess:.12g}"]
        density = "${clump_density}"
    for i, (place, size) in enumerate(zip(places, sizes, strict=True)):
        lines.append(f"create_atoms 1 single {numbers([*place, 0.0][:3])} units box")
        more = f" mol {clumps[0][i]}" if clumps else ""
        if clumps and np.any(clumps[1][i]):
            more += " image " + " ".join(str(int(n)) for n in [*clumps[1][i], 0][:3])
        lines.append(f"set atom {i + 1} diameter {size:.9g} density {density}{more}")
    pathlib.Path(args.out + ".liggghts").write_text("\n".join(lines) + "\n")
    rows = [",".join(f"{v:.9g}" for v in (*place, size)) for place, size in zip(places, sizes, strict=True)]
    head = "x,y,diameter" if dimensions(args) == 2 else "x,y,z,diameter"
    pathlib.Path(args.out + ".csv").write_text("\n".join([head, *rows]) + "\n")


def main():
    args = arguments()
    if args.seed < 0:
        fail("--seed is a whole number of at least 0")
    refuse_others(args)
    random = np.random.default_rng(args.seed)
    sizes = diameters(args, random)
    if args.look:
        return
    make_folder(args)
    print(f"packing | {len(sizes)} {kind(args)} move apart until none overlaps by more than {args.overlap:g} radii; this may take minutes",
          flush=True)
    low, high = ends(args)
    d = dimensions(args)
    if args.clump:
        packing = pack_clumps(args, sizes, random)
        left = packing.left
    else:
        margin = 0.5 * sizes
        places, left = relax(args, random.uniform(low + margin[:, None], high - margin[:, None]), sizes)
    fraction = BALL[d] * (sizes**d).sum() / np.prod(high - low)
    if left > args.overlap:
        fail(f"overlaps of {left:.2g} radii are left at a fraction of {fraction:.3f}; take a lower "
             "fraction or a larger --overlap")
    if args.clump:
        write(args, packing.places, packing.diameters, (packing.clumps, packing.images), packing.excess)
    else:
        write(args, places, sizes)
    print(f"packing | {len(sizes)} {kind(args)}, {'area' if d == 2 else 'volume'} fraction {fraction:.3f}, largest overlap {max(left, 0):.2g} radii "
          f"-> {args.out}.liggghts, {args.out}.csv")
    if args.clump:
        ends_of = packing.diameters.min(), packing.diameters.max()
        print(f"packing | their {len(packing.diameters)} {'discs' if d == 2 else 'spheres'} have diameters of {ends_of[0]:.9g} … "
              f"{ends_of[1]:.9g} m: particles.diameter of a scene")


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        print("packing | stopped: interrupted by Ctrl-C", file=sys.stderr)
        sys.exit(1)
    except OSError as error:
        fail(f"{error.filename}: {error.strerror}; give another --out, in a folder that exists")
