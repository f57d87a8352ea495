"""Seconds to an error of one per cent, of the default and of the one before it, from the rows of a case."""

import math

from bplbm.report.cases import AT_REST, FREE

WANTED = 1.0  # %


def doubt(row):
    """Error that a user must reckon with: mean and half of the spread over places, at least the reference's own."""
    return max(abs(row["error_percent"]) + row["spread_percent"] / 2, row["reference_uncertainty_percent"])


def series(rows, scheme):
    """Rows of a scheme that differ in size alone, coarse ones first: dict of the rest of the choice -> rows."""
    found = {}
    for r in rows:
        if r["scheme"] == scheme and r["status"] == "ok":
            found.setdefault(r["choice"].partition(", ")[2], []).append(r)
    return {rest: mine for rest, mine in found.items() if len(mine) > 1}


def reached(rows, wanted=WANTED):
    """Seconds at which the error falls to `wanted`, between the last row above it and the next one, on a line in
    log-log, and those two rows; (seconds, None, row) where the coarsest row is below already, nothing where the finest
    one is not."""
    if doubt(rows[-1]) > wanted:
        return None
    above = [i for i, r in enumerate(rows) if doubt(r) > wanted]
    if not above:
        return rows[0]["seconds"], None, rows[0]
    a, b = rows[above[-1]], rows[above[-1] + 1]
    part = math.log(doubt(a) / wanted) / math.log(doubt(a) / doubt(b))
    return a["seconds"] * (b["seconds"] / a["seconds"])**part, a, b


def best(rows, scheme):
    """The cheapest of a scheme's series, or nothing."""
    return min(filter(None, (reached(mine) for mine in series(rows, scheme).values())), key=lambda found: found[0], default=None)


def said(rows, scheme):
    found = best(rows, scheme)
    if not found:
        mine = [r for one in series(rows, scheme).values() for r in one if doubt(r) <= WANTED]
        below = list(dict.fromkeys(r["choice"].partition(",")[0] for r in mine))
        return f"not reached for good: less at {', '.join(below)}, more again at the finest run" if below else "not reached"
    seconds, a, b = found
    if not a:
        return f"{seconds:.2g} s at most ({b['choice']}, the coarsest run)"
    sign = ", where its error changes sign" if a["error_percent"] * b["error_percent"] < 0 else ""
    return f"{seconds:.2g} s (between {a['choice'].partition(',')[0]} and {b['choice']}{sign})"


def compared(new, former):
    """How the times of two schemes compare, where they are known."""
    if not new or not former or not former[1]:
        return ""
    factor = former[0] / new[0]
    if not new[1]:
        return f": at least {factor:.2g} times less" if factor > 1 else ""
    return f": {factor:.2g} times less" if factor > 1 else f": {1 / factor:.2g} times more"


def text_of_seconds(rows):
    """A sentence on bodies at rest and one on free ones."""
    lines = []
    for new, former in (AT_REST, FREE):
        if not any(r["scheme"] == new for r in rows) or not any(r["scheme"] == former for r in rows):
            continue
        lines.append(f"Seconds to {WANTED:g} %: {new}, {said(rows, new)}; {former}, {said(rows, former)}"
                     f"{compared(best(rows, new), best(rows, former))}.  ")
    return lines
