"""Where the time of a run went, from its summary and the solid's log."""

import re

SOLID = {"contacts": "Pair", "neighbours": "Neigh", "ranks": "Comm", "output": "Outpt", "other": "Other"}


def solid_seconds(log):
    """Seconds of LIGGGHTS' parts from the last table of times in its log, which counts the wait for the fluid among its
    other work: dict part -> seconds, "waiting" last; empty without such a table."""
    if "Loop time of" not in log:
        return {}
    last = log[log.rindex("Loop time of"):]
    seconds = {part: float(re.search(rf"^{key} +time \(%\) = (\S+)", last, re.M).group(1)) for part, key in SOLID.items()}
    told = re.search(r"fix lbm/couple: .* (\S+) s of waiting for the fluid, (\S+) s of it before the first step", log)
    waiting = float(told.group(1)) - float(told.group(2)) if told else 0.0
    seconds["other"] = max(0.0, seconds["other"] - waiting)
    return {**seconds, "waiting": waiting}
