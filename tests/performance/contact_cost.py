"""Cost of a step of our bonds in LIGGGHTS against its own linear contact, in turns, LIGGGHTS alone on one core.

    contact_cost.py [--edge 10] [--steps 2000] [--rounds 5]

EDGE³ spheres overlap slightly on a cubic lattice in a periodic box, sheared slowly: six contacts each that
last. hooke/stiffness with the history of its tangential force, bond/contact without any bond, and with all pairs bonded.
Prints microseconds a step of the pair style and of all, and the ratios of neighbours in time: median and quartiles.
"""

import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))

from bplbm.mpi_job import environment  # noqa: E402
from bplbm.project import BIN  # noqa: E402

SCRIPT = """
units si
atom_style granular
atom_modify map array
boundary p p p
newton off
communicate single vel yes
region box block 0 {size} 0 {size} 0 {size} units box
create_box 1 box
neighbor 0.001 bin
neigh_modify delay 0
lattice sc {pitch}
create_atoms 1 box
set type 1 diameter 0.01 density 2500
{law}
pair_coeff * *
fix move all nve/sphere
velocity all ramp vx 0 1e-3 y 0 {size} units box
{bonds}
timestep 1e-5
thermo 100000
run {steps}
"""
COMMON = "fix mu all property/global coefficientFriction peratomtypepair 1 0.3\n"
HOOKE = COMMON + """fix kn all property/global kn peratomtypepair 1 1000
fix kt all property/global kt peratomtypepair 1 1000
fix gn all property/global gamman peratomtypepair 1 10
fix gt all property/global gammat peratomtypepair 1 10
pair_style gran model hooke/stiffness tangential history"""
BOND = COMMON + """fix p1 all property/global contactNormalStiffness peratomtypepair 1 1000
fix p2 all property/global contactShearStiffness peratomtypepair 1 1000
fix p4 all property/global contactDampingRatio peratomtypepair 1 0.1
fix p5 all property/global bondNormalStiffness peratomtypepair 1 1000
fix p6 all property/global bondShearStiffness peratomtypepair 1 1000
fix p7 all property/global bondTensileStrength peratomtypepair 1 1
fix p8 all property/global bondShearStrength peratomtypepair 1 1
pair_style gran model bond/contact"""
LAWS = {"hooke/stiffness": (HOOKE, ""), "bond/contact, no bonds": (BOND, ""),
        "bond/contact, all bonded": (BOND, "fix bonds all bond/create gap 1e-5")}


def run(folder, edge, steps, law, bonds):
    """@return microseconds a step of the pair style and of all"""
    pitch = 0.00999
    (folder / "in").write_text(SCRIPT.format(size=pitch * edge, pitch=pitch, law=law, bonds=bonds, steps=steps))
    job = subprocess.run(["taskset", "-c", "0", "mpirun", "--bind-to", "none", "-np", "1", str(BIN / "liggghts"), "-in", "in",
                          "-screen", "none", "-log", "log"], cwd=folder, env=environment(shared=True), check=False, capture_output=True,
                         text=True, timeout=600)
    if job.returncode:
        sys.exit(job.stdout + job.stderr)
    log = (folder / "log").read_text()
    pair = float(re.search(r"^Pair +time \(%\) = (\S+)", log, re.M).group(1))
    return np.array([pair, float(re.search(r"Loop time of (\S+)", log).group(1))]) * 1e6 / steps


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--edge", type=int, default=10)
    p.add_argument("--steps", type=int, default=2000)
    p.add_argument("--rounds", type=int, default=5)
    args = p.parse_args()
    found = {name: [] for name in LAWS}
    with tempfile.TemporaryDirectory() as name:
        for _ in range(args.rounds):
            for law, (text, bonds) in LAWS.items():
                found[law].append(run(pathlib.Path(name), args.edge, args.steps, text, bonds))
    first = np.array(found["hooke/stiffness"])
    for law, times in found.items():
        ratio = np.percentile(np.array(times) / first, [25, 50, 75], axis=0)
        pair, whole = np.median(times, axis=0)
        print(f"{args.edge ** 3} spheres, {law}: pair style {pair:.4g} µs a step, {ratio[1, 0]:.3f} ({ratio[0, 0]:.3f} … "
              f"{ratio[2, 0]:.3f}) of hooke/stiffness; all {whole:.4g} µs, {ratio[1, 1]:.3f} ({ratio[0, 1]:.3f} … "
              f"{ratio[2, 1]:.3f})")


if __name__ == "__main__":
    main()
