"""Memory and time of a block of many bonded spheres that sinks in a closed box, on one rank a side.

    many_bonds.py [--edge 47] [--intervals 10] [--fluid-ranks 1] [--solid-ranks 1]

EDGE³ spheres of six cells (47: 103 823) touch each other on a cubic lattice, each bonded to its six neighbours. Prints one
line: seconds an interval of the whole job, its parts, processor time, and the memory of both programs.
"""

import argparse
import json
import pathlib
import re
import resource
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))

from bplbm.mpi_job import environment  # noqa: E402
from bplbm.project import BIN, CASES, home  # noqa: E402

CELL, DIAMETER, MARGIN = 1e-3, 6e-3, 24  # [m], [m], cells around the block
GAP = 1e-9  # [m] between neighbours

SCENE = """title = "many bonds"
[box]
size = [{size}, {size}, {size}]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, 0.0, -0.5]
velocity_scale = 0.05
[particles]
diameter = {diameter}
density = 1200.0
contact_stiffness = 100.0
[particles.variables]
bond_stiffness = 100.0
bond_strength = 0.05
bond_shear_strength = 0.05
damping_ratio = 0.3
friction = 0.3
bond_gap = 1e-6
[numerics]
cell = {cell}
precision = "single"
[coupling]
timeout = 600.0
[run]
end_time = {end}
[output]
probe_particles = [1]
probe_every = {end}
"""

SCRIPT = """
variable disc_density equal ${{density_max}}*2/3*${{diameter_max}}
include {common}/bonded.liggghts
lattice sc {pitch}
region block block {lo} {hi} {lo} {hi} {lo} {hi} units box
create_atoms 1 region block
set type 1 diameter ${{diameter_max}} density ${{density_max}}
fix move all nve/sphere
fix weight all gravity ${{gravity}} vector ${{gravity_x}} ${{gravity_y}} ${{gravity_z}}
fix bonds all bond/create gap ${{bond_gap}}
fix breaks all bond/breaks every ${{substeps}}00 file ${{out_folder}}/breaks.csv
timestep ${{solid_step}}
thermo 1000
fix fluid all lbm/couple every ${{substeps}}
run ${{solid_steps_total}}
"""


def write(folder, edge, intervals):
    cells = 6 * edge + 2 * MARGIN
    pitch, lo = DIAMETER + GAP, CELL * MARGIN
    (folder / "scene.toml").write_text(SCENE.format(size=CELL * cells, diameter=DIAMETER, cell=CELL, end=2e-3 * intervals))
    script = SCRIPT.format(common=CASES / "common", pitch=pitch, lo=lo, hi=lo + pitch * (edge - 0.5))
    (folder / "in.liggghts").write_text((CASES / "common" / "box.liggghts").read_text() + script)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--edge", type=int, default=47)
    p.add_argument("--intervals", type=int, default=10)
    p.add_argument("--fluid-ranks", type=int, default=1)
    p.add_argument("--solid-ranks", type=int, default=1)
    args = p.parse_args()
    folder = home() / "out" / "many_bonds"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    write(folder, args.edge, args.intervals)
    line = ["mpirun", "--bind-to", "none", "--oversubscribe", "-np", str(args.fluid_ranks), str(BIN / "lbm"), "scene.toml",
            "--out", "out", "--progress", "none", ":", "-np", str(args.solid_ranks), str(BIN / "liggghts"), "-in", "in.liggghts",
            "-log", "liggghts.log", "-screen", "none"]
    job = subprocess.run(line, cwd=folder, env=environment(shared=True), check=False, capture_output=True, text=True,
                         timeout=3000)
    if job.returncode:
        sys.exit(job.stdout + job.stderr)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    s = json.loads((folder / "out" / "summary.json").read_text())
    intervals = round(s["physical_seconds"] / s["parameters"]["interval"])
    parts = ", ".join(f"{part} {100 * share:.0f} %" for part, share in sorted(s["time_share"].items(), key=lambda i: -i[1])
                      if share > 0.005)
    solid = re.search(r"Memory usage per processor = (\S+) Mbytes", (folder / "liggghts.log").read_text())
    print(f"{args.edge ** 3} spheres, {s['bonds']['intact']} bonds, {s['cells']} cells, {s['substeps']} substeps: "
          f"{s['wall_seconds'] / intervals:.3g} s an interval ({s['mlups']:.3g} million updates/s), {parts}; processors "
          f"{used.ru_utime + used.ru_stime:.0f} s; the fluid took {s['peak_megabytes']['all']:.0f} MB, LIGGGHTS "
          f"{float(solid.group(1)) if solid else float('nan'):.0f} MB a rank; the largest process "
          f"{1.024e-3 * used.ru_maxrss:.0f} MB")


if __name__ == "__main__":
    main()
