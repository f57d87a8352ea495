"""A run that ended before its scene does: its results are told, and not judged."""

import json

from bplbm.toml_text import read_laid_over

STEADY = "steady"  # how the ending of a run begins that needed no more time
INTERVALS = 1.0 + 1e-6  # by which an end may be rounded


def early_end(summary, files):
    """Why the results of a run are not judged, as "ended at 0.1 of 60 s"; None of a run that came to its end. One that is
    steady, or that the solid's script has ended, has come to it.

    @param files  the paths of the scene and its overlays, in their order
    """
    try:
        end = float(read_laid_over(files)["run"]["end_time"])
    except (OSError, ValueError, KeyError, TypeError):
        return None
    reached, ending, p = summary.get("physical_seconds", end), summary.get("ending", ""), summary.get("parameters", {})
    interval = p.get("interval", p.get("solid_step", 0.0))
    if reached + INTERVALS * interval >= end * (1 - 1e-9) or ending.startswith((STEADY, "stopped by solid")):
        return None
    return f"ended at {reached:.6g} of {end:.6g} s"


def mark(out, files):
    """Notes in summary.json, as `not_judged`, why a run's results count for nothing, whose `pass` is null then."""
    path = out / "summary.json"
    summary = json.loads(path.read_text())
    why = early_end(summary, files)
    if not why:
        return
    summary["not_judged"] = why
    summary["results"] = [{**r, "pass": None} for r in summary.get("results", [])]
    part = path.with_suffix(".json.part")
    part.write_text(json.dumps(summary, indent=2, ensure_ascii=False) + "\n")
    part.replace(path)
