"""The commands in the documents: each starts a tool or program that is there and knows the options. Commands on a scene of
`cases/` are looked at as `tools/run` does before it builds. Nothing is run."""

import functools
import re
import shlex
import subprocess
import sys

from bplbm.checks.documents import WRITTEN_BY_TOOLS, name, tracked
from bplbm.project import BIN, CASES, ROOT

HISTORY = {"CHANGELOG.md"}  # tells of commands as they were
OURS = r"tools/[\w.]+|(?:\S*/bin/)?(?:lbm|liggghts|replay|trace|\w+_benchmark|\w+_report|reference_engine|lammps_engine)"
# Programs of the system, which are taken as they are.
SYSTEM = {"cmake", "cpack", "h5dump", "h5repack", "sbatch", "source", "cd", "apt", "pip", "python3", "export", "printf", "cat"}
STARTS = re.compile(rf"(?:[A-Z_]+=\S+ )*(?:{OURS}|mpirun|bplbm|cmake|sbatch|python3)(?=\s|$)")
PLACEHOLDER = re.compile(r"[…|\\]|\b[A-Z][A-Z_]*\b")


def commands(text):
    """Whole lines of code blocks and code within a line that begin as a command does."""
    code, kept = False, ""
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            code = not code
            continue
        found = [line.strip()] if code else re.findall(r"`([^`]+)`", line)
        for command in found:
            command = kept + command
            kept = command[:-1] if code and command.endswith("\\") else ""  # goes on in the next line
            drawn = re.search(r"\S {3,}\S", command.split(" #")[0])  # a drawing or a table, no command
            if not kept and STARTS.match(command) and not drawn:
                yield number, command


@functools.cache
def help_of(*words):
    said = subprocess.run([*words, "--help"], cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
    return said.stdout + said.stderr if said.returncode == 0 else ""


def parts(command):
    """The programs that a command starts, each with its words."""
    for piece in re.split(r" : | && |\(|\)| ; ", re.sub(r"\s#.*", "", command)):
        try:
            words = shlex.split(piece)
        except ValueError:
            words = piece.split()
        while words and re.fullmatch(r"[A-Z_]+=\S*", words[0]):
            words = words[1:]
        if words and words[0] == "mpirun":
            words = words[1:]
        while words and words[0].startswith("-"):  # of mpirun
            words = words[2:] if words[0] in ("-np", "-n", "--bind-to") else words[1:]
        if words:
            yield words


def wrong_options(words, known, text):
    for word in words:
        option = re.match(r"--[a-z][\w-]*", word)
        if not option or re.search(rf"(?<![\w-]){re.escape(option[0])}(?![\w-])", known):
            continue
        if f"{option[0][2:]}-" not in text:  # else an overlay KEY-VALUE.toml of the scene that the text makes
            yield f"knows no {option[0]}"


def of_a_tool(words, text):
    tool = ROOT / words[0]
    if not tool.exists():
        yield "there is no such tool"
    elif tool.suffix or tool.is_dir():  # a file that is named, or a part of a check
        return
    elif words[0] == "tools/run" and len(words) > 1 and (CASES / words[1]).is_dir() and not PLACEHOLDER.search(" ".join(words)):
        said = subprocess.run([sys.executable, str(ROOT / "tools/launch.py"), "--look", *words[1:]], cwd=ROOT, timeout=60,
                              capture_output=True, text=True, check=False)
        if said.returncode:
            yield (said.stderr or said.stdout).strip()
    else:
        known = help_of(str(tool)) + (help_of(str(tool), "--list") if words[0] == "tools/test" else "")
        yield from wrong_options(words[1:], known, text)


def of_a_program(words, text):
    program = BIN / words[0].split("/")[-1]
    if program.name == "output_benchmark":  # only where parallel HDF5 is installed
        return
    if not program.exists():
        yield f"there is no {program}"
        return
    if program.name == "liggghts":  # reads LIGGGHTS' own options
        return
    subs = [w for w in words[1:2] if re.fullmatch(r"[a-z]+", w)]
    yield from wrong_options(words[1:], help_of(str(program)) + (help_of(str(program), *subs) if subs else ""), text)


def complaints():
    for path in tracked("*.md"):
        if name(path) in HISTORY or WRITTEN_BY_TOOLS.match(name(path)):
            continue
        text = path.read_text()
        for number, command in commands(text):
            for words in parts(command):
                first = words[0]
                if first.startswith("tools/"):
                    found = of_a_tool(words, text)
                elif re.fullmatch(OURS, first):
                    found = of_a_program(words, text)
                elif first == "bplbm":
                    known = (ROOT / "tools/bplbm/command.py").read_text()
                    found = [f"bplbm knows no {w}" for w in words[1:2][0].split("|") if w not in known] if words[1:] else []
                else:
                    found = [] if first in SYSTEM else [f"'{first}' is no program that is known"]
                for problem in found:
                    yield f"{name(path)}:{number}: {command}: {problem}"


def main():
    found = list(complaints())
    print("\n".join(found) or "check | all commands of the documents are known")
    return 1 if found else 0
