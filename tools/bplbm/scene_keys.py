"""The keys of a scene and their units, as the program of the fluid prints them."""

import difflib
import functools
import subprocess

from bplbm.project import INSTALLED, fluid_program
from bplbm.sweep_values import Mistake

VARIABLES = "particles.variables"


@functools.cache
def units():
    """Each key, without numbers of entries (boundary.pressure), -> its unit or "". Nothing where no program is built."""
    try:
        said = subprocess.run([fluid_program(), "--keys"], capture_output=True, text=True, timeout=20, check=True).stdout
    except (OSError, subprocess.SubprocessError):
        return {}
    rows = [[cell.strip(" `") for cell in line.split("|")[1:4]] for line in said.splitlines()[2:]]
    return {key: unit for key, _, unit in rows}


def plain(path):
    """A path without the numbers of entries, as the table of keys has it."""
    return ".".join(part for part in path if isinstance(part, str))


def check(paths):
    """Throws Mistake for a path that no scene can have."""
    known = units()
    for key in map(plain, paths):
        if known and key not in known and not key.startswith(f"{VARIABLES}.") and not any(k.startswith(f"{key}.") for k in known):
            near = difflib.get_close_matches(key, known, 1, 0.8)
            raise Mistake(f"no scene has a key '{key}'" + (f"; is it {near[0]}?" if near else f"; {'bplbm keys' if INSTALLED else 'lbm --keys'} lists them"))


def with_unit(name, path):
    """A column's name: that of the key, with its unit where it has one."""
    unit = units().get(plain(path), "") if path else ""
    return f"{name} [{unit}]" if unit else name
