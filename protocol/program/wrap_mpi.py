# SPDX-License-Identifier: MIT
"""Writes the functions of mpi_calls.h: wrap_mpi.py mpi.h mpi_calls.cpp mpi_calls.inc

The second file has X(NAME) for each function that takes a communicator, for the test that calls them all.
"""

import pathlib
import re
import sys

PROTOTYPE = re.compile(r"\bint\s+(MPI_\w+)\s*\(([^()]*)\)([^;]*);")
# No communicator among their arguments, but they wait, or are called while waiting.
WAITS = re.compile(r"MPI_(Wait|Test)(all|any|some)?|MPI_Mrecv|MPI_Win_(fence|wait|free)|MPI_Comm_disconnect|MPI_File_(close|\w+_all)")
# Their meaning is the program's affair; see program.h and liggghts_coupling/host/mpi_guards.cpp.
OWN = {"MPI_Abort"}

TEXT = """// Written by wrap_mpi.py: do not change.
#include "protocol/program/mpi_calls.h"

#include "protocol/program/watch.h"

#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

namespace {{

MPI_Comm own_world = MPI_COMM_NULL;

MPI_Comm meant(MPI_Comm comm) {{
  return comm == MPI_COMM_WORLD && own_world != MPI_COMM_NULL ? own_world : comm;
}}

}}  // namespace

void protocol::replace_world(MPI_Comm own) {{
  own_world = own;
}}

extern "C" {{

{functions}
}}  // extern "C"
"""
FUNCTION = """int {name}({parameters}) {{
  const protocol::Waiting here("{name}");
  return P{name}({arguments});
}}
"""


def arguments(parameters):
    """(name, whether it is a communicator) of each parameter."""
    for parameter in parameters.split(","):
        name = re.search(r"(\w+)\s*((\[\w*\])*)\s*$", parameter).group(1)
        yield name, re.fullmatch(r"\s*MPI_Comm\s+\w+\s*", parameter) is not None


def wrappers(header):
    """(name, text of the function, whether it takes a communicator)"""
    header = re.sub(r"/\*.*?\*/", " ", header, flags=re.S)
    for name, parameters, attributes in PROTOTYPE.findall(header):
        if name in OWN or "removed" in attributes or "..." in parameters:
            continue
        parameters = " ".join(parameters.split())
        found = list(arguments(parameters)) if parameters != "void" else []
        takes = any(comm for _, comm in found)
        if takes or WAITS.fullmatch(name):
            passed = ", ".join(f"meant({argument})" if comm else argument for argument, comm in found)
            yield name, FUNCTION.format(name=name, parameters=parameters, arguments=passed), takes


def main(header, source, names):
    found = {name: (text, takes) for name, text, takes in wrappers(pathlib.Path(header).read_text())}
    for must in ("MPI_Send", "MPI_Wait", "MPI_Allreduce", "MPI_Comm_dup"):
        if must not in found:
            sys.exit(f"wrap_mpi.py | error | {header} declares no {must} that can be read; is it an mpi.h?")
    pathlib.Path(source).write_text(TEXT.format(functions="\n".join(text for text, _ in found.values())))
    pathlib.Path(names).write_text("".join(f"X({name})\n" for name, (_, takes) in found.items() if takes))


main(*sys.argv[1:])
