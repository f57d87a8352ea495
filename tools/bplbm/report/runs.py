"""One run of tools/report: a scene with an overlay, kept in out/report and not run again."""

import importlib.util
import json
import re
import subprocess

from bplbm.mpi_job import environment
from bplbm.output_folder import mark
from bplbm.project import BIN, CASES, home
from bplbm.toml_text import toml

OUT = home() / "out" / "report"
ONE_MACHINE = {"OMPI_MCA_pml": "ob1"}  # no search for networks: 0.2 s less of each start


def progress(case, text):
    print(f"report | {case} | {text}", flush=True)


def merged(*overlays):
    out = {}
    for overlay in overlays:
        for name, table in overlay.items():
            out[name] = table if isinstance(table, list) else {**out.get(name, {}), **table}
    return out


def module_of(scene):
    """The scene's plot.py, which knows how to measure its runs."""
    spec = importlib.util.spec_from_file_location(f"plot_{scene}", CASES / scene / "plot.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def is_coupled(scene):
    return (CASES / scene / "in.liggghts").exists()


def run_scene(folder, scene, overlay, files=(), again=False, limit=900.0, ranks=1):
    """Runs a scene of cases/, or in a folder elsewhere, with an overlay, unless it has been, the fluid on some ranks.
    Returns exit code and the last error line."""
    mark(folder, scene)  # lbm writes into no folder of others, and this one holds an overlay already
    text, done = toml(overlay), folder / "row.json"
    if not again and done.exists():
        kept = json.loads(done.read_text())
        if kept["overlay"] == text:
            return kept["code"], kept["error"]
    (folder / "overlay.toml").write_text(text)
    paths = [str(CASES / scene / f) for f in ("scene.toml", *files)] + [str(folder / "overlay.toml")]
    line = ["mpirun", "--bind-to", "none", "--oversubscribe", "-np", str(ranks), str(BIN / "lbm"), *paths, "--out", str(folder),
            "--force", "--progress", "none"]
    if is_coupled(scene):
        line += [":", "-np", "1", str(BIN / "liggghts"), "-in", str(CASES / scene / "in.liggghts"), "-log",
                 str(folder / "liggghts.log"), "-screen", "none", "-var", "out_folder", str(folder)]
    try:
        job = subprocess.run(line, env={**environment(shared=True), **ONE_MACHINE}, capture_output=True, text=True,
                             timeout=limit, check=False)
        code, output = job.returncode, job.stdout + job.stderr
    except subprocess.TimeoutExpired:
        code, output = 124, f"lbm | error | took longer than {limit:.0f} s"
    errors = re.findall(r"lbm \| error \| (.*)", output)
    error = errors[-1] if errors else ""
    done.write_text(json.dumps({"overlay": text, "code": code, "error": error}))
    return code, error


def verdict(code, error):
    if code == 0:
        return "bounded"
    if code == 2:
        return "refused"
    found = re.search(r"interval (\d+)", error)
    return f"blown up at step {found.group(1)}" if code == 3 and found else f"failed ({code})"
