"""The command line of tools/run, and the names that follow from it: files of the scene, output folder."""

import argparse
import math
import pathlib
import shlex
import shutil
import sys

from bplbm.project import home, tool
from bplbm.scenes import Unknown, find, scenes

BAD_INPUT = 2
MOST_THREADS = 1024
ENGINES = ("liggghts", "lammps", "yade", "reference", "python", "c", "fortran")


def fail(text, code=BAD_INPUT):
    print(f"run | error | {text}", file=sys.stderr)
    sys.exit(code)


def list_scenes(only=None):
    """Prints all scenes of cases/, or one, with their choices."""
    for scene in [only] if only else map(find, scenes()):
        print(f"{scene.name:20} {scene.heading()}")
        own = "".join(f"; --{key} {'|'.join(values)}|all" for key, values in scene.options().items())
        print(f"{'':20} sets: {', '.join(scene.sets())}; variants: {', '.join(scene.variants()) or '-'}{own}")


def whole(text):
    """A number of ranks or threads."""
    if not text.isascii() or not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is no whole number of at least 1")
    return int(text)


def seconds(text):
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value > 0):
        raise argparse.ArgumentTypeError(f"'{text}' is no positive number of seconds")
    return value


class Parser(argparse.ArgumentParser):
    def error(self, message):
        fail(f"{message}; see {tool('run')} --help")


def parser():
    p = Parser(prog=tool("run"), description="Runs a scene and draws its pictures.", allow_abbrev=False)
    p.add_argument("scene", nargs="?", help="name of a folder in cases/, or the path of a scene's folder or scene.toml")
    p.add_argument("--list", action="store_true", help="scenes with their sets and variants, or those of SCENE")
    p.add_argument("--set", default="resolved", help="parameter set: resolved, literal, fine")
    p.add_argument("--variant", default="", help="overlay variant-NAME.toml of the scene")
    p.add_argument("--overlay", action="append", default=[], metavar="FILE",
                   help="a TOML file whose keys replace the scene's, laid over it last; may be repeated")
    p.add_argument("--fluid-ranks", type=whole, default=1, metavar="N")
    p.add_argument("--solid-ranks", type=whole, default=1, metavar="M")
    p.add_argument("--threads", type=whole, default=1, metavar="T", help=f"of the fluid; at most {MOST_THREADS}")
    p.add_argument("--no-bind", action="store_true", help="leave it to the system on which cores the processes run; else each "
                   "has its own where there are enough")
    p.add_argument("--engine", choices=ENGINES, help="who moves the particles (default: liggghts); yade suits particles of one "
                   "size without a script, reference, python, c and fortran free discs")
    p.add_argument("--engine-command", metavar="'COMMAND'", help="any other program that does; in its words {folder} is the "
                   "scene's folder and {out} the output folder")
    p.add_argument("--until", type=seconds, metavar="SECONDS", help="stop at this physical time")
    p.add_argument("--judge", action="store_true", help="judge the results also where --until ends the run early")
    p.add_argument("--record", metavar="FILE", help="write the exchange to a trace")
    p.add_argument("--restart", action="store_const", const="checkpoint", help="go on from the checkpoint in --out")
    p.add_argument("--accept", action="append", default=[], metavar="KEY",
                   help="with --restart: a key or table of the scene that may have changed, e.g. fluid.body_force")
    p.add_argument("--restart=fault", dest="restart", action="store_const", const="fault",
                   help="go on from the states that both programs kept at a fault")
    p.add_argument("--out", metavar="DIR", help="a new, an empty or an earlier run's folder; default: "
                   "out/SCENE[-SET][-VARIANT] (of the current folder for a scene outside cases/), "
                   "where an earlier run is renamed to ….1, ….2 and so on")
    p.add_argument("--force", action="store_true", help="replace an earlier run in the output folder")
    p.add_argument("--no-page", action="store_true", help="write no page (index.html in the output folder)")
    p.add_argument("--no-build", action="store_true", help="take the programs as they are built; install and build nothing")
    p.add_argument("--look", action="store_true", help=argparse.SUPPRESS)  # at the arguments, and go
    p.add_argument("--no-study", action="store_true", help="leave out the scene's comparison runs")
    p.epilog = "A scene may have choices of its own (--list), as --start 5 of disc_migration."
    return p


def arguments(words):
    """Checked arguments; `scene` is a Scene, `own` holds its own choices as pairs (KEY, VALUE)."""
    options = parser()
    args, rest = options.parse_known_args(words)
    args.words = list(words)
    if not args.scene and rest:
        fail(f"no option '{rest[0]}' without a scene; see {tool('run')} --help")
    if not args.scene:
        return args
    try:
        args.scene = scene = find(args.scene)
    except Unknown as unknown:
        fail(unknown)
    if args.set not in scene.sets():
        fail(f"{scene.name} has no set '{args.set}'; there are: {', '.join(scene.sets())}")
    if args.variant and args.variant not in scene.variants():
        fail(f"{scene.name} has no variant '{args.variant}'; there are: {', '.join(scene.variants()) or 'none'}")
    if args.threads > MOST_THREADS:
        fail(f"--threads {args.threads}: a rank takes at most {MOST_THREADS}; take more --fluid-ranks")
    if args.accept and not args.restart:
        fail("--accept says what a restart may change; give it with --restart")
    if args.force and args.restart:
        fail("--force replaces an earlier run and --restart goes on from it; give one of them")
    for overlay in args.overlay:
        if not pathlib.Path(overlay).is_file():
            fail(f"--overlay {overlay}: there is no such file")
    check_engine(args)
    if scene.is_solid_alone:
        check_alone(args)
    refuse_clashes(scene, options)
    args.own = own_choices(scene, rest)
    return args


def check_engine(args):
    """--engine or --engine-command, whose words replace it; the default where neither is given."""
    if args.engine_command is not None:
        if args.engine:
            fail("--engine names one of our engines and --engine-command is any other program; give one of them")
        try:
            args.engine_command = shlex.split(args.engine_command)
        except ValueError as error:
            fail(f"--engine-command: {error}; quote it as a whole, e.g. 'python3 my_engine.py'")
        if not args.engine_command or shutil.which(args.engine_command[0]) is None:
            fail(f"--engine-command: there is no program '{(args.engine_command or [''])[0]}'")
    args.engine = args.engine or "liggghts"


def check_alone(args):
    """LIGGGHTS alone takes no option of the fluid or of the exchange."""
    given = {"--fluid-ranks": args.fluid_ranks > 1, "--threads": args.threads > 1, "--record": args.record,
             "--restart": args.restart, "--engine": args.engine != "liggghts", "--engine-command": args.engine_command}
    for option, wrong in given.items():
        if wrong:
            fail(f"{args.scene.name} has no fluid, LIGGGHTS runs alone: leave {option} out")


def refuse_clashes(scene, options):
    """An overlay KEY-VALUE.toml whose KEY is an option of ours could never be chosen."""
    for key, values in scene.options().items():
        if f"--{key}" in options._option_string_actions:  # argparse has no other way to ask
            fail(f"{scene.folder / f'{key}-{values[0]}.toml'}: --{key} is an option of {tool('run')}, so this overlay cannot be "
                 f"chosen; rename it, e.g. to my_{key}-{values[0]}.toml for --my_{key} {values[0]}")


def own_choices(scene, words):
    """Pairs (KEY, VALUE) of the words that are no options of ours."""
    known, chosen, rest = scene.options(), [], list(words)
    while rest:
        key, value = rest.pop(0), rest.pop(0) if rest else ""
        if not key.startswith("--") or key[2:] not in known:
            fail(f"{scene.name} knows no '{key}'; see {tool('run')} --help"
                 + "".join(f", and --{k} {'|'.join(v)}|all" for k, v in known.items()))
        if value != "all" and value not in known[key[2:]]:
            fail(f"{key} of {scene.name} is one of: {', '.join(known[key[2:]])}, all")
        if key[2:] in dict(chosen):
            fail(f"{key} is given twice; give one value of it, or all")
        chosen.append((key[2:], value))
    return chosen


def one_value(args, who):
    """Refuses `all` where a tool takes one value of a choice."""
    if key := next((key for key, value in args.own if value == "all"), None):
        fail(f"--{key} all: {who} takes one value of it: {', '.join(args.scene.options()[key])}")


def label(args):
    """Name of the overlays beside the set: VARIANT, KEY-VALUE and names of overlay files, joined."""
    return "_".join([*([args.variant] if args.variant else []), *(f"{key}-{value}" for key, value in args.own),
                     *(pathlib.Path(overlay).stem for overlay in args.overlay)])


def out_folder(args):
    """out/SCENE… of the checkout for a scene of cases/, else of the current folder."""
    parts = [args.scene.name] + ([args.set] if args.set != "resolved" else []) + ([label(args)] if label(args) else [])
    return (home() if args.scene.shipped else pathlib.Path.cwd()) / "out" / "-".join(parts)


def scene_files(args):
    """Paths of the scene and its overlays, in the order in which they replace each other."""
    folder = args.scene.folder
    files = [args.scene.file]
    files += [folder / f"{args.set}.toml"] if args.set != "resolved" else []
    files += [folder / f"variant-{args.variant}.toml"] if args.variant else []
    files += [folder / f"{key}-{value}.toml" for key, value in args.own]
    files += [pathlib.Path(overlay).resolve() for overlay in args.overlay]
    return [str(f) for f in files]
