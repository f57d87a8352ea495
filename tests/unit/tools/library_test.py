"""The library of protocol/ alone: built with MPI only, installed to a bare prefix, found by CMake and pkg-config; the
engines in C and Fortran built against it as projects of their own run a scene."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))

from bplbm.project import BIN  # noqa: E402

ENGINES = ROOT / "tools" / "engines"
SCENE = ROOT / "cases" / "settling_disc" / "scene.toml"
MPIRUN = ["mpirun", "--oversubscribe", "--bind-to", "none", "-np", "1"]
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_mpi_yield_when_idle="1")
THREE_LINES = """find_package(bplbm REQUIRED)
add_executable(engine engine.c)
target_link_libraries(engine PRIVATE bplbm::protocol)
"""


class Library(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        shutil.copytree(ROOT / "protocol", cls.folder / "wire")  # under another name, without its neighbours
        cls.prefix = cls.folder / "prefix"
        cls.said = cls.run_("cmake", "-S", cls.folder / "wire", "-B", cls.folder / "build", "-DCMAKE_BUILD_TYPE=None",
                            "-DCMAKE_DISABLE_FIND_PACKAGE_HDF5=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON",
                            "-DCMAKE_DISABLE_FIND_PACKAGE_CLI11=ON").stdout
        cls.run_("cmake", "--build", cls.folder / "build", "--parallel", "2")
        cls.run_("cmake", "--install", cls.folder / "build", "--prefix", cls.prefix)

    @classmethod
    def run_(cls, *words, **more):
        done = subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=240, check=False, **more)
        if done.returncode:
            raise AssertionError(f"{words}\n{done.stdout}{done.stderr}")
        return done

    def fall(self, engine):
        """Runs a short scene; returns the last row of its probes."""
        run = pathlib.Path(tempfile.mkdtemp(dir=self.folder))
        (run / "short.toml").write_text("[numerics]\ncells_per_diameter = 10\n[run]\nend_time = 0.05\n")
        self.run_(*MPIRUN, BIN / "lbm", SCENE, "short.toml", "--progress", "none", ":", "-np", "1", engine, cwd=run,
                  env=ENVIRONMENT)
        return (run / "out" / "probes.csv").read_text().splitlines()[-1]

    def test_it_says_what_it_does_without(self):
        self.assertIn("HDF5 not found: recordings, replay and trace are left out", self.said)
        self.assertFalse(list(self.prefix.rglob("hdf5_file.h")))
        self.assertTrue((self.prefix / "include" / "bplbm_solid.h").exists())

    def test_it_asks_nothing_of_its_user_but_mpi(self):
        for file in self.prefix.rglob("*.cmake"):
            for word in ("Werror", "march", "fmt", "hdf5", "HDF5", "CLI11"):
                self.assertNotIn(word, file.read_text(), file)

    def test_engines_built_with_three_lines_and_with_pkg_config_run_alike(self):
        source = self.folder / "engine"
        source.mkdir()
        shutil.copy(ENGINES / "c" / "engine.c", source)
        (source / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.21)\nproject(engine C)\n" + THREE_LINES)
        self.run_("cmake", "-S", source, "-B", source / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}")
        self.run_("cmake", "--build", source / "build")
        moved = self.prefix.rename(self.folder / "moved")  # the file of pkg-config knows where it lies
        self.addCleanup(moved.rename, self.prefix)
        config, = moved.rglob("bplbm.pc")
        flags = self.run_("pkg-config", "--cflags", "--libs", "bplbm",
                          env=dict(os.environ, PKG_CONFIG_PATH=str(config.parent))).stdout.split()
        self.run_("mpicc", source / "engine.c", *flags, "-o", self.folder / "other")
        other = self.fall(self.folder / "other")
        moved.rename(self.prefix)
        self.assertEqual(self.fall(source / "build" / "engine"), other)
        self.prefix.rename(moved)

    def test_installed_programs_find_the_library(self):
        build, prefix = self.folder / "programs", self.folder / "with_programs"
        self.run_("cmake", "-S", self.folder / "wire", "-B", build, "-DCMAKE_BUILD_TYPE=None")
        self.run_("cmake", "--build", build, "--parallel", "2")
        self.run_("cmake", "--install", build, "--prefix", prefix)
        moved = prefix.rename(self.folder / "elsewhere")
        bare = {name: value for name, value in ENVIRONMENT.items() if name != "LD_LIBRARY_PATH"}
        for program in ("trace", "replay"):
            self.assertIn("Usage", self.run_(moved / "bin" / program, "--help", env=bare).stdout)

    def fall_alone(self, folder):
        """The last row of an engine's probes, which is built as a project of its own."""
        build = self.folder / folder
        self.run_("cmake", "-S", ENGINES / folder, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}")
        self.run_("cmake", "--build", build, "--parallel", "2")
        return [float(number) for number in self.fall(build / f"{folder}_engine").split(",")]

    def test_engines_are_projects_of_their_own(self):
        falls = [self.fall_alone(folder) for folder in ("c", "reference") + ("fortran",) * bool(shutil.which("gfortran"))]
        for other in falls[1:]:
            for a, b in zip(falls[0], other, strict=True):
                self.assertAlmostEqual(a, b, delta=1e-9 * max(1.0, abs(a)))


if __name__ == "__main__":
    unittest.main()
