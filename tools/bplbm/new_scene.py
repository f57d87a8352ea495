"""Makes the folder of a new scene from a template, ready to run.

    tools/new sand --kind packed --dimensions 2

A template is a folder of templates/: a line that begins with `@2 ` or `@3 ` is for that many dimensions, NAME is the
scene's name, WHAT a disc or a sphere, SHOWS what the kind shows, CHECK the command that looks at a scene, and TUTORIAL,
SCENE.md and COMMANDS.md are the paths of these documents.
"""

import argparse
import pathlib
import random
import re
import shutil
import sys
import tomllib
from dataclasses import dataclass

from bplbm.project import CASES, INSTALLED, ROOT, TOOLS, tool
from bplbm.scenes import scenes

TEMPLATES = pathlib.Path(__file__).resolve().parent / "templates"
SEED = 1


@dataclass(frozen=True)
class Kind:
    """What a template shows, which files of cases/common it includes, and how high its bed is."""

    shows: str
    includes: tuple  # besides box.liggghts
    bed: dict  # dimensions -> height of the bed [m] before it settles; empty: no bed
    short: float  # end [s] of a short run


KINDS = {
    "free": Kind("a particle settles in a closed box", ("discs", "spheres"), {}, 0.2),
    "packed": Kind("a stream over a bed of loose grains", (), {2: 0.0075, 3: 0.0072}, 0.02),
    "bonded": Kind("a jet from below into a bed of cemented grains", ("bonded",), {2: 0.0075, 3: 0.0072}, 0.02),
}


class Refused(Exception):
    """Why no scene can be made there, and what to do."""


def checked(path):
    """The folder to make. Throws Refused."""
    name = path.resolve().name
    if not re.fullmatch(r"[A-Za-z0-9][\w.+-]*", name):
        raise Refused(f"'{name}': a scene's name has letters, digits and _ . + - in it")
    if name in scenes() and path.resolve().parent != CASES:
        raise Refused(f"'{name}' is a scene of cases/; choose another name")
    if path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise Refused(f"{path} exists; choose another name, or remove it first")
    return path


def rendered(text, name, dimensions, shows=""):
    """A template's text for so many dimensions."""
    lines = []
    for line in text.splitlines():
        if line[:3] in ("@2 ", "@3 "):
            if line[1] != str(dimensions):
                continue
            line = line[3:]
        lines.append(line)
    what = "disc" if dimensions == 2 else "sphere"
    text = "\n".join(lines).replace("NAME", name).replace("WHAT", what).replace("RUN ", tool("run") + " ")
    for word, told in (("CHECK", "bplbm check" if INSTALLED else "lbm check"), ("TUTORIAL", CASES / "TUTORIAL.md"),
                       ("SCENE.md", ROOT / "lbm_solver/docs/scene.md"),
                       ("COMMANDS.md", ROOT / "liggghts_coupling/docs/commands.md")):
        text = text.replace(word, str(told))
    return text.replace("SHOWS", shows) + "\n"


def bed(size, diameters, height, random_numbers):
    """Places and diameters [m] of grains that touch nothing, in staggered layers up to a height."""
    smallest, largest = diameters
    pitch = 1.02 * largest
    *across, _ = size
    grains = []
    for layer in range(int(height / pitch)):
        offset = 0.25 * pitch * (1 + layer % 2)
        counts = [int((length - offset - 0.26 * pitch) / pitch) for length in across]
        for index in range(counts[0] * (counts[1] if len(counts) > 1 else 1)):
            steps = [index % counts[0], *([index // counts[0]] if len(counts) > 1 else []), layer]
            diameter = random_numbers.uniform(smallest, largest)
            free = 0.5 * (pitch - diameter)
            offsets = [offset] * len(across) + [0.0]
            grains.append(([offsets[k] + (steps[k] + 0.5) * pitch + random_numbers.uniform(-free, free)
                            for k in range(len(size))], diameter))
    return grains


def packing(grains, dimensions):
    """LIGGGHTS commands that create the grains, and nothing when a run goes on from a checkpoint."""
    lines = [f"# {len(grains)} {'discs' if dimensions == 2 else 'spheres'}; made by {tool('new')}. {tool('make_packing')} makes dense "
             "ones."]
    density = "${disc_density}" if dimensions == 2 else "${density_max}"
    for i, (place, diameter) in enumerate(grains, 1):
        x, y, z = [*place, 0.0][:3]
        lines += [f"create_atoms 1 single {x:.9g} {y:.9g} {z:.9g} units box",
                  f"set atom {i} diameter {diameter:.9g} density {density}"]
    return "\n".join(lines) + "\n"


def copy_common(folder, kind):
    """What the script includes, so that the scene may lie, and move, anywhere."""
    common = folder / "common"
    common.mkdir()
    for name in ("box", *kind.includes):
        text = (CASES / "common" / f"{name}.liggghts").read_text()
        (common / f"{name}.liggghts").write_text(text.replace("${scene_folder}/../common", "${scene_folder}/common"))
    shutil.copytree(CASES / "common" / "restarted", common / "restarted")


def make(path, kind_name, dimensions):
    """Writes the scene. Returns its folder."""
    kind, folder = KINDS[kind_name], checked(path)
    folder.mkdir(parents=True, exist_ok=True)
    files = {"scene.toml": f"{kind_name}/scene.toml", "in.liggghts": f"{kind_name}/in.liggghts", "README.md": "README.md",
             **({"relax.liggghts": "relax.liggghts"} if kind.bed else {})}
    for name, template in files.items():
        (folder / name).write_text(rendered((TEMPLATES / template).read_text(), folder.resolve().name, dimensions, kind.shows))
    (folder / "variant-short.toml").write_text(f"# Only what changes.\n[run]\nend_time = {kind.short}  # s\n")
    copy_common(folder, kind)
    if kind.bed:
        tables = tomllib.loads((folder / "scene.toml").read_text())
        grains = bed(tables["box"]["size"], tables["particles"]["diameter"], kind.bed[dimensions], random.Random(SEED))
        (folder / "packing.liggghts").write_text(packing(grains, dimensions))
    return folder


def run_command():
    """What starts a run: of a checkout with its whole path, since the scene may lie anywhere."""
    return tool("run") if INSTALLED else TOOLS / "run"


def main():
    p = argparse.ArgumentParser(prog=tool("new"), description=__doc__.splitlines()[0])
    p.add_argument("name", nargs="?", metavar="NAME", help="folder to make, as sand or studies/sand")
    p.add_argument("--kind", choices=[*KINDS], default="free", help="; ".join(f"{k}: {v.shows}" for k, v in KINDS.items()))
    p.add_argument("--dimensions", type=int, choices=(2, 3), default=2, help="discs in two, spheres in three; default 2")
    p.add_argument("--list", action="store_true", help="the kinds, and nothing else")
    args = p.parse_args()
    if args.list:
        print("\n".join(f"{name:8} {kind.shows}" for name, kind in KINDS.items()))
        return 0
    if not args.name:
        p.error(f"which name? as {tool('new')} sand")
    try:
        folder = make(pathlib.Path(args.name), args.kind, args.dimensions)
    except Refused as refusal:
        print(f"new | error | {refusal}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"new | error | {error.filename}: {error.strerror}; choose another place", file=sys.stderr)
        return 2
    print(f"new | {folder}: {KINDS[args.kind].shows}, {args.dimensions}D")
    print(f"new | next: edit {folder / 'scene.toml'}, then {run_command()} {folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
