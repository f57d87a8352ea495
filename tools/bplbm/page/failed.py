"""The page of a run that did not come to its end: why, and what it had made until then."""

import html
import re

import h5py
import numpy as np

from bplbm.mpi_job import reason_of
from bplbm.page import flow, histories, sensors
from bplbm.page.html import page, row, section
from bplbm.page.run import how, said, warnings
from bplbm.page.setup import setup
from bplbm.reading import read_table
from bplbm.results import Run
from bplbm.toml_text import read_laid_over

ENDED = {1: "a fault, a lost partner, or it was told to end", 3: "numerics: the fluid became too fast or not finite"}


class Unfinished(Run):
    """An output folder without summary.json: what can be known of it."""

    def __init__(self, folder, tables):  # noqa: super().__init__ wants a summary
        self.folder = folder
        size = tables["box"]["size"]
        self.parameters = {f"box_{axis}": length for axis, length in zip("xyz", size, strict=False)}
        self.summary = {"physical_seconds": self.reached(), "results": [], "versions": {}}

    def reached(self):
        """The time of the last frame or row [s]."""
        times = [0.0]
        try:
            with h5py.File(self.folder / "fields.h5") as file:
                self.parameters["cell"] = float(file.attrs["cell"])
                times += [float(file[name].attrs["time"]) for name in file]
        except (OSError, KeyError):
            pass
        try:
            times += [float(np.max(read_table(self.folder / "probes.csv")["time"], initial=0.0))]
        except (OSError, ValueError, KeyError):
            pass
        return max(times)


def attempt(part, *arguments):
    """A part of the page; nothing where what it needs is missing or cut off."""
    try:
        return part(*arguments)
    except (OSError, ValueError, KeyError, IndexError, AttributeError, TypeError):
        return ""


def why(folder, text):
    """What ended a run. text: its error.log; where no program told an error, how the fluid's log says that it ended (by a
    signal, say), before what mpirun says of any job."""
    if "| error |" not in text:
        try:
            endings = re.findall(r"^ending\s+(.*)$", (folder / "lbm.log").read_text(errors="replace"), re.M)
        except OSError:
            endings = []
        if endings:
            return endings[-1]
    return reason_of(text)


def write_failed_page(folder, scene, files, words, line, code):
    """Writes index.html of a run that ended with an exit code other than 0. Arguments as those of write_page.

    @return  its path. Throws OSError or ValueError where it cannot be written or the scene cannot be read.
    """
    tables = read_laid_over(files)
    run = Unfinished(folder, tables)
    log = folder / "error.log"
    text = log.read_text(errors="replace") if log.is_file() else ""
    planes = attempt(flow.read_planes, run) or []
    moving = attempt(flow.animation, run, planes) if any(plane.fluid[1] for plane in planes) else ""
    if planes and not moving:
        moving = '<p class="soft">Only the state at the start was written; a smaller output.fields_every shows more.</p>'
    title = f"{scene.name}: failed"
    shown = page(title, f"<h1>{html.escape(title)}</h1>",
                 f'<p><span class="bad">exit code {code}</span> ({html.escape(ENDED.get(code, "bad input"))}) '
                 f'after {run.summary["physical_seconds"]:.6g} s of flow</p>',
                 section("Why", f"<p><b>{html.escape(why(folder, text))}</b></p>",
                         f"<details><summary>all that was said</summary><pre>{html.escape(text)}</pre></details>"),
                 f'<div class="row"><div>{section("Set-up", attempt(setup, run, tables, scene.folder))}</div>'
                 f'<div style="flex:1;min-width:320px">{section("Flow until then", moving)}</div></div>',
                 section("Histories until then", row(attempt(histories.charts, run, planes))),
                 section("Sensors until then", row(attempt(sensors.charts, run))),
                 section("What was on", said(run)), section("Warnings and hints", warnings(run)),
                 section("How to repeat it", *how(run, tables, scene, words, line)),
                 scripts=["flow.js"] if 'id="flow"' in moving else [])
    path = folder / "index.html"
    part = path.with_suffix(".part")
    part.write_text(shown)
    part.replace(path)
    return path
