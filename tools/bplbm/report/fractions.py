"""How a cell's solid fraction is found: error and cost of the rule that the code takes, and of others."""

import json
import subprocess

from bplbm.project import BIN
from bplbm.report.runs import OUT, progress


def fractions(again):
    """A row a rule, from scheme_report: name, root-mean-square error of surface cells, nanoseconds a disc."""
    kept = OUT / "fractions.json"
    if again or not kept.exists():
        subprocess.run([str(BIN / "scheme_report"), "--fractions", "--json", str(kept)], stdout=subprocess.DEVNULL,
                       timeout=300.0, check=True)
    rows = json.loads(kept.read_text())
    for row in rows:
        progress("fractions", f"{row['rule']}: rms error {row['rms']:.4f}, {row['nanoseconds_a_disc']:.0f} ns a disc")
    return rows


def text_of_fractions(rows):
    return ["## Solid fraction of a cell", "",
            "Surface cells of 400 discs of ten cells at many places within a cell, one cell at a time (a run takes eight at once).",
            "", "| rule | rms error | ns a disc |", "|---|---|---|",
            *(f"| {row['rule']} | {row['rms']:.4f} | {row['nanoseconds_a_disc']:.0f} |" for row in rows), ""]
