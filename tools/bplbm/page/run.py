"""The page of a run: index.html in its output folder, one file that needs nothing else."""

import html
import os
import pathlib
import platform
import re
import shlex
import subprocess
import time

from bplbm.costs import solid_seconds
from bplbm.logs import warning_lines
from bplbm.page import flow, histories, sensors
from bplbm.page.html import Cell, page, row, section, table
from bplbm.page.picture import data_url
from bplbm.page.setup import setup
from bplbm.project import INSTALLED, ROOT, repeated
from bplbm.quantities import not_told
from bplbm.results import Run
from bplbm.toml_text import read_laid_over, toml
from bplbm.written import error_text, share_text

PARTS = {"sweep": "#1f6fb4", "placing": "#7a5bb0", "loads": "#2f8f4e", "exchange": "#b8860b", "output": "#6b7280",
         "waiting": "#d9dee5", "contacts": "#1f6fb4", "neighbours": "#7a5bb0", "ranks": "#b8860b", "other": "#2f8f4e"}
MEANING = {"sweep": "stream and collide", "placing": "cover cells", "loads": "sum loads",
           "exchange": "talk to other ranks and the solid", "waiting": "wait for the other program"}
LARGEST_PICTURE = 6_000_000  # bytes of a picture that is put into the page


def named_unit(number):
    return "–" if number["unit"] in ("1", "") else number["unit"]


def judged(r, not_judged=""):
    """The row of a result; not_judged: why it counts for nothing."""
    verdict = '<span class="good">pass</span>' if r["pass"] else '<span class="bad">miss</span>'
    if not_judged:
        verdict = f'<span class="note">not judged: {html.escape(not_judged)}</span>'
    return [r["name"], r["value"], named_unit(r), r["reference"],
            Cell(error_text(r["error"]), r["error"], "n"), Cell(f"{100 * r['tolerance']:.2g} %", r["tolerance"], "n"), Cell(verdict, r["pass"]), r["source"]]


def results(run):
    """What was judged, and what was only measured."""
    told = run.quantities
    heads = ["result", "value", "unit", "reference", "error", "tolerance", "", "source"]
    return (table(heads, [judged(r, run.summary.get("not_judged", "")) for r in run.results]) if run.results else "", "<p></p>" if run.results and told else "",
            table(["quantity", "value", "unit"], [[q["name"], q["value"], named_unit(q)] for q in told]) if told else "",
            "".join(f'<p class="soft">{html.escape(line)}</p>' for line in not_told(run)))


def bar(seconds, whole, name):
    """Shares of a time as a bar with its legend."""
    parts = {part: s for part, s in seconds.items() if s > 0.002 * whole}
    spans = "".join(f'<span style="width:{100 * s / whole:.2f}%;background:{PARTS.get(part, "#999")}" title="{part}"></span>'
                    for part, s in parts.items())
    entries = [f'<span style="color:{PARTS.get(part, "#999")}">■</span> {MEANING.get(part, part)} {html.escape(share_text(s / whole))}'
               for part, s in sorted(parts.items(), key=lambda item: -item[1])]
    return (f'<p style="margin:8px 0 0"><b>{name}</b>, {whole:.3g} s</p><div class="bar">{spans}</div>'
            f'<p class="soft">{" · ".join(entries)}</p>')


def costs(run):
    s = run.summary
    wall = s["wall_seconds"]
    text = bar({part: share * wall for part, share in s["time_share"].items()}, wall, "the fluid")
    for log in sorted(run.folder.glob("*.log")):
        if log.name != "lbm.log" and (seconds := solid_seconds(log.read_text(errors="replace"))):
            text += bar(seconds, sum(seconds.values()), f"the solid ({log.stem})")
    size = ", ".join(f"{part} {mb:.3g} MB" for part, mb in s["megabytes"].items())
    return text + (f'<p>{s["steps"]} steps of {s["cells"]} cells, {s["mlups"]:.3g} million updates a second; CPU time of the '
                   f'fluid {s["cpu_seconds"]:.3g} s; memory: {html.escape(size)}. Largest Mach number u/c<sub>s</sub> '
                   f'{s["ma_max"]:.3g}, mass drift {s["mass_drift"]:.1e}.</p>')


def said(run):
    """What was on, from the head of the fluid's log."""
    log = run.folder / "lbm.log"
    head = log.read_text(errors="replace").split("\n\n")[0] if log.is_file() else ""
    return f"<pre>{html.escape(head)}</pre>" if head else ""


def warnings(run):
    """Lines of both logs that warn or advise, each once."""
    rows = [[name, line] for name, line in warning_lines(run.folder)]
    return table(["log", "line"], rows) if rows else '<p class="soft">None in either log.</p>'


def pictures(run):
    """Those that the scene's plot.py has drawn."""
    found = []
    for path in sorted([*run.folder.glob("*.png"), *run.folder.glob("*.gif")]):
        source = data_url(path.read_bytes(), f"image/{path.suffix[1:]}") if path.stat().st_size < LARGEST_PICTURE else path.name
        name = html.escape(path.name)
        found.append(f'<figure><img src="{source}" alt="{name}"><figcaption>{name}</figcaption></figure>')
    return "".join(found)


def commit():
    """That of the checkout; nothing of an installed tree, whose version says what it is."""
    if INSTALLED:
        return ""
    try:
        said = subprocess.run(["git", "-C", str(ROOT), "describe", "--always", "--dirty"], capture_output=True, text=True,
                              timeout=5, check=False).stdout.strip()
    except (OSError, subprocess.TimeoutExpired):
        said = ""
    return f"commit {said}" if said else ""


def machine():
    try:
        name = re.search(r"model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text())
    except OSError:
        name = None
    return f"{name.group(1) if name else platform.processor()}, {os.cpu_count()} cores"


def details(title, text):
    return f"<details><summary>{html.escape(title)}</summary><pre>{html.escape(text)}</pre></details>"


def how(run, tables, scene, words, line):
    """How to run it again."""
    versions = ", ".join(f"{name} {version}" for name, version in run.summary["versions"].items())
    script = scene.script("liggghts")
    return (f"<pre>{html.escape(repeated('run', words))}</pre>"
            f'<p class="soft">{html.escape(" · ".join(w for w in (versions, commit(), machine()) if w))}</p>',
            details("the command of the job", shlex.join(line)), details("scene.toml with its overlays", toml(tables)),
            details(script.name, script.read_text(errors="replace")) if script.is_file() else "")


def write_page(folder, scene, files, words, line):
    """Writes index.html of a finished run.

    @param scene  the Scene; files: the paths of its TOML files, in the order of overlays
    @param words  of the command line of tools/run; line: that of the job
    @return       its path. Throws OSError or ValueError where the run cannot be read.
    """
    run, tables = Run(folder), read_laid_over(files)
    s = run.summary
    planes = flow.read_planes(run)
    moving = flow.animation(run, planes)
    title = " ".join(w for w in (scene.name, s["set"] if s["set"] != "resolved" else "", s["variant"]) if w)
    written = time.localtime((run.folder / "summary.json").stat().st_mtime)
    text = page(title, f"<h1>{html.escape(title)}</h1>",
                f'<p class="soft">{html.escape(scene.heading())} · {s["physical_seconds"]:.6g} s of flow in '
                f'{s["wall_seconds"]:.3g} s, {html.escape(s.get("not_judged") or s["ending"])} · {time.strftime("%Y-%m-%d %H:%M", written)}</p>',
                section("Results", *results(run)),
                f'<div class="row"><div>{section("Set-up", setup(run, tables, scene.folder))}</div>'
                f'<div style="flex:1;min-width:320px">{section("Flow", moving)}</div></div>',
                section("Histories", row(histories.charts(run, planes))),
                section("Sensors", row(sensors.charts(run))), section("Averages", *sensors.averages(run)),
                section("Pictures of the scene", pictures(run)),
                section("Where the time went", costs(run)), section("What was on", said(run)),
                section("Warnings and hints", warnings(run)),
                section("How to repeat it", *how(run, tables, scene, words, line)),
                scripts=["flow.js"] if moving else [])
    path = run.folder / "index.html"
    part = path.with_suffix(".part")
    part.write_text(text)
    part.replace(path)
    return path
