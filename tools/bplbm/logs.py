"""What the logs of a run say."""

import json
import re

WARNS = re.compile(r"\bwarning\b|^hint\b", re.I)
OWN_HINT = r"hint.* wait(s|ing) \d+ %"  # of the fluid on its waiting


def warning_lines(folder):
    """Lines of all logs in a folder that warn or advise, each once: (name of the log, line). One of LIGGGHTS that
    `liggghts` has told with its line of the script is left out."""
    lines = []
    for log in sorted(folder.glob("*.log")):
        for line in log.read_text(errors="replace").splitlines():
            if WARNS.search(line):
                lines.append((log.name, re.sub(r"\s+", " ", line.strip())))
    if hint := hint_of_run(folder):  # the fluid knows its own waiting only
        lines = [(name, line) for name, line in lines if not re.search(OWN_HINT, line)] + [("tools/run", hint)]
    told = " ".join(line for _, line in lines if line.startswith("liggghts | warning"))
    return [(name, line) for name, line in dict.fromkeys(lines)
            if not (line.startswith("WARNING: ") and re.sub(r" \(\S*:\d+\)$", "", line)[9:] in told)]


def hint_of_run(folder):
    """What tools/run saw of the whole job (summary.json), or None."""
    summary = folder / "summary.json"
    return json.loads(summary.read_text()).get("hint") if summary.exists() else None
