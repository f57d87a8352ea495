"""The programs of a run: which of them it needs, where they are, and whether they can run here."""

import shutil

from bplbm.options import fail
from bplbm.project import BIN, INSTALLED, TOOLS, fluid_program, missing_cpu_features
from bplbm.toml_text import read_laid_over


def engine_program(engine):
    """The file of an engine: tools/engines/NAME/engine.py, or where there is none what is compiled as NAME_engine."""
    script = TOOLS / "engines" / engine / "engine.py"
    return script if script.exists() else BIN / (engine if engine == "liggghts" else f"{engine}_engine")


def lbm_2d_is_enough(args):
    """Whether a scene is in the plane, and no file of it or beside it asks for single precision: its comparison runs take
    the same program. A file that cannot be read is lbm's to complain of."""
    def is_single(path):
        try:
            return read_laid_over([path])["numerics"]["precision"] == "single"
        except (OSError, ValueError, KeyError, TypeError):
            return False

    return args.scene.dimension == 2 and not any(map(is_single, [*args.scene.folder.glob("*.toml"), *args.overlay]))


def needed(args):
    """What has to be built for a run. The kernels in space and in single precision take most of the time: a run that has
    no use for them waits for them only where they have been built before."""
    targets = []
    if not args.scene.is_solid_alone:
        targets.append("lbm_2d" if lbm_2d_is_enough(args) and not (BIN / "lbm").exists() else "lbm")
    program = engine_program(args.engine)
    used = not args.engine_command and (args.scene.is_coupled or args.scene.is_solid_alone)
    if program.suffix != ".py" and (used or args.engine != "liggghts"):
        targets.append(program.name)
    return targets


def check(args):
    """Refuses a run whose programs are not there, or were compiled for another processor."""
    if missing := missing_cpu_features():
        fail(f"these programs were compiled for a processor with {', '.join(missing)}, which this machine lacks; "
             "install a package for this processor, or build from the sources")
    if (args.no_build or INSTALLED) and not fluid_program().exists():
        what = "install the package again" if INSTALLED else "leave --no-build out, or run tools/build"
        fail(f"{BIN / 'lbm'} is missing: {what}")
    if args.no_build and args.engine == "liggghts" and not args.engine_command and args.scene.is_coupled \
            and not (BIN / "liggghts").exists():
        fail(f"{BIN / 'liggghts'} is missing: run tools/build, or take an engine that does without LIGGGHTS "
             "(--engine reference or python, --engine-command)")
    if INSTALLED and args.engine != "liggghts" and not engine_program(args.engine).exists():
        fail(f"--engine {args.engine} is not part of the package; build BPLBM from its sources for it")
    if shutil.which("mpirun") is None:
        fail(f"mpirun not found; {'install openmpi-bin' if INSTALLED else 'run tools/install'}")
