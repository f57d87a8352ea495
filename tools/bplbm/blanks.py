"""Folders with a blank in their name, at which a script of LIGGGHTS or LAMMPS parts its words."""

import glob
import pathlib
import re

SCENE = re.compile(r"\$\{scene_folder\}")
OUTPUT = re.compile(r"\$\{(out_folder|mesh\d+)\}")  # meshes are written to the output folder
RESTART = re.compile(r"\$\{restart_file\}")
INCLUDE = re.compile(r"\s*include\s+\$\{(?:scene_folder|fresh)\}/(\S+)")


def lines_of(script, folder, seen):
    """File, number and text of each line of a script, and of those that it includes from the scene's folder. seen: files
    that were read already."""
    if script in seen or not script.is_file():
        return
    seen.add(script)
    for number, line in enumerate(script.read_text(errors="replace").splitlines(), 1):
        line = line.partition("#")[0]
        yield script, number, line
        if found := INCLUDE.match(line):
            names = re.sub(r"\$\{\w+\}", "*", found[1])  # a variable of the scene chooses among files
            for path in sorted(glob.glob(f"{glob.escape(str(folder))}/{names}")):
                yield from lines_of(pathlib.Path(path).resolve(), folder, seen)


def has_blank(path):
    return any(letter.isspace() for letter in str(path))


def refusal(script, folder, out, restart):
    """Why a script cannot run with these folders, as a sentence with a cure; None where it can.

    @param folder  of the scene; out: of the output; restart: whether the run goes on from files there
    """
    if not has_blank(folder) and not has_blank(out):
        return None
    for file, number, line in lines_of(script, folder, set()):
        where = f"LIGGGHTS parts words there, and {file.name}, line {number}, names files in it"
        if has_blank(folder) and SCENE.search(line):
            return f"{folder}: the scene's folder has a blank in its name: {where}; rename every folder of this path that has one"
        if has_blank(out) and (OUTPUT.search(line) or restart and RESTART.search(line)):
            return f"{out}: the output folder has a blank in its name: {where}; give --out a folder without one in its whole path"
    return None
