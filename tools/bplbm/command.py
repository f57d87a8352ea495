"""bplbm COMMAND …: the command of an installed BPLBM. `bplbm --help` lists the commands."""

import importlib
import os
import subprocess
import sys

from bplbm.options import scene_files
from bplbm.project import BIN, CASES, ROOT, fluid_program
from bplbm.toml_text import read_laid_over

MODULES = {
    "new": ("bplbm.new_scene", "makes the folder of a new scene from a template"),
    "run": ("bplbm.run", "runs a scene, judges its results, draws its pictures and makes its page"),
    "sweep": ("bplbm.sweep", "runs a scene with all combinations of some values: one table, one page"),
    "compare": ("bplbm.compare", "shows the results of runs side by side"),
    "draw_setup": ("bplbm.setup_drawing", "draws what the files of a scene describe"),
    "make_packing": ("bplbm.packing", "makes a dense packing of grains"),
    "make_clump": ("bplbm.clump", "fills a closed surface with spheres"),
    "report": ("bplbm.report.command", "speed against error of every choice, and the stability of hard cases"),
}
OWN = {"check": "looks at a scene without running it: grid, steps, numbers, what is on, the time to expect",
       "keys": "every key of a scene with type, unit, default, range and meaning; with a part of a name those that hold it",
       "where": "prints the folders of the programs, the scenes and the documents; of one of them with its name"}
OF_CHECK = ("--liggghts-vars",)  # options of lbm check, handed on
PROGRAMS = {"trace": "looks at, compares, cuts and draws recorded exchanges", "replay": "plays a recorded exchange to a program"}


def help_text():
    lines = [f"  {name:14}{text}" for name, text in
             [*((n, t) for n, (_, t) in MODULES.items()), *OWN.items(), *PROGRAMS.items()]]
    return "\n".join(["usage: bplbm COMMAND [options]     bplbm COMMAND --help says more", "", *lines, "",
                      "Scenes are named by the path of their folder, or by their name in " + str(CASES) + ";",
                      "outputs go to out/ of the current folder.", ""])


def mistake(text):
    print(f"bplbm | error | {text}", file=sys.stderr)
    return 2


def note_on_partner(scene, files):
    """What bplbm run would refuse: a script without [coupling], or [coupling] without a script. None where they agree, or
    where lbm has to complain."""
    try:
        is_coupled = "coupling" in read_laid_over(files)
    except (OSError, ValueError):
        return None
    script = scene.script("liggghts")
    if scene.is_coupled and not is_coupled:
        return (f"{scene.name} has no [coupling], but its folder has {script.name}, which bplbm run starts and lbm then refuses; add "
                "[coupling] and [particles] to the scene, or rename the script for a fluid alone")
    if is_coupled and not scene.is_coupled:
        return (f"{scene.name} has [coupling], but its folder has no {script.name}; write one, which may be empty where "
                "--engine-command names a program of your own")
    return None


def check(words):
    """lbm check of a scene and its overlays, chosen as with bplbm run. Ends the process."""
    from bplbm.options import arguments, fail, one_value
    if not words or words[0] in ("-h", "--help"):
        print("usage: bplbm check SCENE [--set NAME] [--variant NAME] [--KEY VALUE] [--overlay FILE] [--liggghts-vars]\n"
              + OWN["check"] + "\n--liggghts-vars prints the variables that the script of the solid gets instead")
        return 0
    args = arguments([word for word in words if word not in OF_CHECK])
    if not args.scene:
        fail("which scene? bplbm run --list shows them")
    one_value(args, "bplbm check")
    if args.scene.is_solid_alone:
        fail(f"{args.scene.name} has no fluid: there is nothing that lbm could check")
    if note := note_on_partner(args.scene, scene_files(args)):
        print(f"check | note | {note}", file=sys.stderr, flush=True)
    os.execv(fluid_program(), [str(fluid_program()), "check", *(word for word in words if word in OF_CHECK), *scene_files(args)])


def keys(words):
    """Prints the table of all keys, or of those with a part of a name in them."""
    if words and words[0] in ("-h", "--help"):
        print(f"usage: bplbm keys [PART]\n{OWN['keys']}")
        return 0
    if words[1:]:
        return mistake("keys: one part of a name, as viscosity, or nothing for all")
    if not words:
        os.execv(fluid_program(), ["lbm", "--keys"])
    said = subprocess.run([fluid_program(), "--keys"], capture_output=True, text=True, timeout=20, check=True).stdout.splitlines()
    found = [line for line in said[2:] if words[0] in line.split("|")[1]]
    if not found:
        return mistake(f"no key of a scene has '{words[0]}' in it; bplbm keys prints all")
    print("\n".join([*said[:2], *found]))
    return 0


def where(words):
    """Prints all places, or the path alone of the one that is named."""
    places = {"programs": BIN, "scenes": CASES, "common": CASES / "common", "python": ROOT / "tools", "documents": ROOT}
    if words and words[0] in ("-h", "--help"):
        print(f"usage: bplbm where [{'|'.join(places)}]\n{OWN['where']}")
        return 0
    if words[1:] or words and words[0] not in places:
        return mistake(f"where: one of {', '.join(places)}, or nothing for all")
    if words:
        print(places[words[0]])
        return 0
    notes = {"common": "scripts that scenes include", "python": "import bplbm", "documents": "README.md; cases/TUTORIAL.md, "
             "RUNNING.md, TROUBLESHOOTING.md, PYTHON.md; lbm_solver/docs/scene.md, output.md"}
    for name, path in places.items():
        print(f"{name:10} {path}" + (f"   ({notes[name]})" if name in notes else ""))
    return 0


def main():
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        print(help_text(), end="")
        return 0 if len(sys.argv) > 1 else 2
    name, words = sys.argv[1], sys.argv[2:]
    if name == "--version":
        os.execv(fluid_program(), ["lbm", "--version"])
    if name in PROGRAMS:
        os.execv(BIN / name, [name, *words])
    if name == "check":
        return check(words)
    if name == "where":
        return where(words)
    if name == "keys":
        return keys(words)
    if name not in MODULES:
        return mistake(f"there is no command '{name}'; there are: {', '.join([*MODULES, *OWN, *PROGRAMS])}")
    sys.argv = [f"bplbm {name}", *words]
    module = importlib.import_module(MODULES[name][0])
    return module.main()


def command_line():
    """main() for the command. Ends the process."""
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        print("bplbm | stopped: interrupted by Ctrl-C", file=sys.stderr)
        sys.exit(1)
    except BrokenPipeError:  # of `bplbm keys | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        sys.exit(1)
    except PermissionError as error:
        sys.exit(mistake(f"{error.filename}: {error.strerror}; choose another folder"))


if __name__ == "__main__":
    command_line()
