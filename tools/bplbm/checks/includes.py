"""Who may include whom: fails with every include that crosses a border it must not cross."""

import pathlib
import re
import sys

from bplbm.project import ROOT

INCLUDE = re.compile(r'^\s*#include\s+[<"]([^>"]+)[>"]', re.M)

# Room -> rooms whose headers it may use besides its own and protocol's messages and errors.
LBM = {
    "base": set(), "lattice": {"base"}, "field": {"base", "lattice"},
    "collision": {"base", "lattice"},
    "viscosity": {"base", "lattice", "collision"},
    "boundary": {"base", "lattice", "field", "collision"},
    "immersed": {"base", "lattice", "field", "collision"},
    "io": {"base", "lattice", "field", "viscosity"},
    "solver": {"base", "lattice", "field", "collision", "viscosity", "boundary", "immersed"},
    "coupling": {"base", "lattice", "field", "collision", "viscosity", "boundary", "immersed", "solver", "io"},
    "main.cpp": {"base", "lattice", "field", "collision", "immersed", "solver", "io", "coupling"},
}
# The same of protocol/; its main programs may use all of them.
PROTOCOL = {"wire": set(), "program": {"wire"}, "transport": {"wire", "program"},
            "solid": {"wire", "program", "transport"}}
# Library header (prefix) -> files that may use it.
ONLY = {
    "mpi.h": r"protocol/(transport/mpi_channel|program/(mpi_calls|program)|solid/).*|lbm_solver/field/decomposition\.h|liggghts_coupling/.*",
    "hdf5": r"protocol/transport/(hdf5_file|trace).*|lbm_solver/io/(field_writer|image_file)\.cpp",
    "lammps": r"liggghts_coupling/(host|bond)/.*",
    "atom.h": r"liggghts_coupling/(host|bond)/.*",
    "fix.h": r"liggghts_coupling/(host|bond)/.*",
    "toml++": r"lbm_solver/io/.*",
    "Eigen": r"lbm_solver/(base/(vec3|pose|mass_moments)|immersed/(body|marked_bodies))\.(h|cpp)",
}


def complaints():
    for path in sorted(ROOT.glob("*/**/*")):
        name = path.relative_to(ROOT).as_posix()
        top = name.split("/")[0]
        if path.suffix not in (".h", ".cpp") or top not in ("protocol", "lbm_solver", "liggghts_coupling"):
            continue
        for header in INCLUDE.findall(path.read_text()):
            owner = header.split("/")[0]
            if top == "protocol" and owner in ("lbm_solver", "liggghts_coupling"):
                yield f"{name} includes {header}: the protocol knows neither program"
            if top == "protocol" and owner == "protocol" and not name.endswith("_main.cpp"):
                room, other = name.split("/")[1], header.split("/")[1]
                if other != room and other not in PROTOCOL[room]:
                    yield f"{name} includes {header}: {room} may use {sorted(PROTOCOL[room]) or 'nothing'}"
            if {top, owner} == {"lbm_solver", "liggghts_coupling"}:
                yield f"{name} includes {header}: the two programs never see each other"
            if top == "lbm_solver" and owner == "lbm_solver":
                room, other = name.split("/")[1], header.split("/")[1]
                if other != room and other not in LBM[room]:
                    yield f"{name} includes {header}: {room} may use {sorted(LBM[room]) or 'nothing'}"
            for prefix, allowed in ONLY.items():
                if (header == prefix or header.startswith((prefix + "/", prefix + "."))) and not re.fullmatch(allowed, name):
                    yield f"{name} includes {header}: only {allowed} may"
        if top == "protocol" and path.suffix in (".h", ".cpp"):
            if "SPDX-License-Identifier: MIT" not in path.read_text():
                yield f"{name} is not marked MIT"


def mixed_units(lists):
    """In a unit that computes no source may call another one (lbm_solver/CMakeLists.txt), nor then know its header."""
    for unit, body in re.findall(r"set\((numbers_\d+)\n(.*?)\)", lists, re.S):
        sources = {name.removesuffix(".cpp") for name in body.split()}
        for source in sorted(sources):
            parts = [ROOT / "lbm_solver" / (source + ending) for ending in (".cpp", ".h")]
            known = set(re.findall(r'#include "lbm_solver/([\w/]+)\.h"', "".join(p.read_text() for p in parts if p.exists())))
            for other in sorted((sources & known) - {source}):
                yield f"lbm_solver/CMakeLists.txt: {source} knows {other}, so they cannot be in one unit ({unit})"


def main():
    found = [*complaints(), *mixed_units((ROOT / "lbm_solver/CMakeLists.txt").read_text())]
    print("\n".join(found) or "include rules hold")
    return 1 if found else 0

