# SPDX-License-Identifier: GPL-2.0-or-later
"""Memory and open files of both programs over many coupling intervals: neither grows.

    flat_memory_test.py BIN [INTERVALS]      default 1e6

A disc settles in a small tube and rests there. The samples of the first fifth are left out: buffers reach their size
meanwhile. From then on a program may not grow by more than 256 kB, which a leak of one byte in four intervals would do,
nor have another number of open files.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PATIENCE = 1500  # s
INTERVAL = 834.0e-6  # s, of the scene: checked against what lbm says
BIN, INTERVALS = None, 1_000_000

SCENE = """title = "small tube"
[box]
size = [0.01, 0.015]
depth = 1.0
sides_x = "wall"
sides_y = "wall"
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, -9.8]
velocity_scale = 0.06
[particles]
diameter = 0.0025
density = 1250.0
start = [[0.005, 0.008]]
contact_stiffness = 2.0e5
[particles.variables]
damping_ratio = 0.5
[numerics]
cells_per_diameter = 5
[coupling]
substeps = 10
[run]
end_time = {end_time}
[output]
probe_every = {probe_every}
"""


class Sample:
    """Resident memory and open files of a process, and how far the run was."""

    def __init__(self, pid, rows):
        status = pathlib.Path(f"/proc/{pid}/status").read_text()
        self.program = re.search(r"Name:\s+(\S+)", status)[1]
        self.kilobytes = int(re.search(r"VmRSS:\s+(\d+)", status)[1])
        self.files = len(os.listdir(f"/proc/{pid}/fd"))
        self.part = rows


def children(pid):
    return [int(c) for task in pathlib.Path(f"/proc/{pid}/task").glob("*/children") for c in task.read_text().split()]


def run_and_watch(folder):
    """Runs the scene. Returns its exit code, what it said, and the samples."""
    env = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_mpi_yield_when_idle="1",
               OMP_NUM_THREADS="1")
    line = ["mpirun", "--bind-to", "none", "--oversubscribe", "-np", "1", f"{BIN}/lbm", "scene.toml", "--progress", "none",
            ":", "-np", "1", f"{BIN}/liggghts", "-screen", "none", "-in", "in.liggghts"]
    samples, begin = [], time.monotonic()
    with open(folder / "said", "w+") as said, subprocess.Popen(line, cwd=folder, env=env, stdout=said, stderr=said) as job:
        while job.poll() is None:
            time.sleep(0.5)
            if time.monotonic() - begin > PATIENCE:
                job.terminate()
            try:
                rows = (folder / "out" / "probes.csv").read_bytes().count(b"\n") - 1
                samples += [Sample(pid, rows / 1000) for pid in children(job.pid)]
            except (OSError, TypeError):  # it begins, or has just ended
                pass
        said.seek(0)
        return job.returncode, said.read(), samples


class FlatMemory(unittest.TestCase):
    def test_neither_program_grows(self):
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary) / "tube"
            folder.mkdir()
            shutil.copytree(ROOT / "cases" / "common", folder.parent / "common")
            shutil.copy(ROOT / "cases" / "settling_disc" / "in.liggghts", folder)
            end = INTERVALS * INTERVAL
            (folder / "scene.toml").write_text(SCENE.format(end_time=end, probe_every=end / 1000))
            code, said, samples = run_and_watch(folder)
            self.assertEqual(code, 0, said)
            made = int(re.search(r"= (\d+) intervals", said)[1])
            self.assertLess(abs(made / INTERVALS - 1), 0.05, said)
        for program in ("lbm", "liggghts"):
            late = [s for s in samples if s.program == program and s.part > 0.2]
            self.assertGreater(len(late), 10, f"too few samples of {program}: {len(samples)}")
            print(f"{program}: {made} intervals, {late[0].kilobytes} kB after a fifth, {late[-1].kilobytes} kB at the end, "
                  f"{late[0].files} and {late[-1].files} open files, {len(late)} samples")
            self.assertLessEqual(max(s.kilobytes for s in late) - late[0].kilobytes, 256, program)
            self.assertEqual({s.files for s in late}, {late[0].files}, program)


if __name__ == "__main__":
    if len(sys.argv) > 2:
        INTERVALS = int(float(sys.argv.pop()))
    BIN = pathlib.Path(sys.argv.pop()).resolve()
    unittest.main()
