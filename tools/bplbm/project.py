"""Where BPLBM lies: a checkout with its build, or an installed tree (PREFIX/bin, PREFIX/lib/bplbm, PREFIX/share/bplbm)."""

import os
import pathlib
import re
import shlex

ROOT = pathlib.Path(__file__).resolve().parents[2]  # of the checkout, or PREFIX/share/bplbm
INSTALLED = not (ROOT / "CMakeLists.txt").exists()
TOOLS = ROOT / "tools"
CASES = ROOT / "cases"
BIN = ROOT.parents[1] / "lib" / "bplbm" / "bin" if INSTALLED else ROOT / "build" / os.environ.get("BPLBM_PRESET", "release") / "bin"


def fluid_program():
    """lbm, or lbm_2d where a first run in the plane has built no more than that."""
    whole, plane = BIN / "lbm", BIN / "lbm_2d"
    return plane if plane.exists() and not whole.exists() else whole


def home():
    """The folder in which `out/` of the shipped scenes is made: an installed tree is never written to."""
    return pathlib.Path.cwd() if INSTALLED else ROOT


def tool(name):
    """How a user calls a command: tools/run, or bplbm run."""
    return f"bplbm {name}" if INSTALLED else f"tools/{name}"


def repeated(name, words):
    """Shell commands that call a tool again with some words, from where it was called."""
    here = pathlib.Path.cwd()
    command = tool(name) if INSTALLED or here == ROOT else shlex.quote(str(ROOT / "tools" / name))
    return f"cd {shlex.quote(str(here))}\n{command} {shlex.join(words)}"


def missing_cpu_features():
    """Instructions that the installed programs were compiled for and this machine lacks; sorted names."""
    try:
        needed = set((BIN.parent / "cpu_features").read_text().split())
        flags = re.search(r"^flags\s*:(.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.M)
    except OSError:
        return []
    return sorted(needed - set(flags.group(1).split())) if flags else []
