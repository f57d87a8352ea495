"""The table and the page of a sweep."""

import csv
import html

import numpy as np

from bplbm.page.chart import Line, line_chart
from bplbm.page.html import Cell, page, section, table
from bplbm.project import repeated

COSTS = ("physical time [s]", "largest Ma", "mass drift", "wall time [s]")
OUT_OF_TOLERANCE = 4
STATUS = {0: ("ok", "good"), OUT_OF_TOLERANCE: ("out of tolerance", "note")}
NOT_JUDGED = "not judged"  # as the reason of such a run begins
OF_REFERENCES = "Out of tolerance: against the references of the scene, which hold for its own values and need not hold for others."
MOST_LINES = 8  # of one chart


def columns_of(rows):
    """Names of all results, in the order in which they come; costs last."""
    found = list(dict.fromkeys(key for row in rows.values() for key in row["results"]))
    return [c for c in found if c not in COSTS] + [c for c in found if c in COSTS]


def status(row):
    """What a run is called, and the class of its colour."""
    if row["code"] == 0 and row["reason"].startswith(NOT_JUDGED):
        return NOT_JUDGED, "note"
    return STATUS.get(row["code"], ("failed", "bad"))


def plain(value):
    """A value as one cell of a CSV file."""
    return " ".join(map(str, value)) if isinstance(value, list) else value


def write_table(folder, varied, rows):
    """sweep.csv: a line a run. varied: keys -> names of their columns. Returns its path."""
    path, columns = folder / "sweep.csv", columns_of(rows)
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*varied.values(), *columns, "status", "reason", "run"])
        for name, row in rows.items():
            writer.writerow([*(plain(row["all"][n]) for n in varied), *(row["results"].get(c, "") for c in columns),
                             status(row)[0], row["reason"], name])
    return path


def shown(value):
    """A value as the page has it: vectors in brackets."""
    return f"({', '.join(map(str, value))})" if isinstance(value, list) else value


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def abscissa(names, rows):
    """The varied number with the most values, which the curves are drawn against; none without one."""
    numeric = [n for n in names if all(is_number(row["all"][n]) for row in rows.values())]
    return max(numeric, key=lambda n: len({row["all"][n] for row in rows.values()}), default=None)


def told(name, value, column):
    """A value of a legend: the last part of its key, and its unit from the name of its column, as `key [unit]`."""
    unit = column.partition(" [")[2].rstrip("]")
    return f"{name.split('.')[-1]} {shown(value)}{' ' + unit if unit else ''}"


def curves(names, varied, rows, column, along):
    """A line for each combination of the other values; the mean of all where there are too many for a chart. varied: keys ->
    names of their columns."""
    groups = {}
    for row in rows.values():
        value = row["results"].get(column)
        if is_number(value):
            others = ", ".join(told(n, row["all"][n], varied[n]) for n in names if n != along)
            groups.setdefault(others, []).append((row["all"][along], value))
    if len(groups) > MOST_LINES:
        groups = {f"mean of {len(groups)} series": [point for points in groups.values() for point in points]}
    lines = []
    for others, points in groups.items():
        x = np.unique([p[0] for p in points])
        y = np.array([np.mean([v for at, v in points if at == one]) for one in x])
        lines.append(Line(others, x, y, marked=True))
    return lines


def charts(names, varied, rows):
    """A chart for each result that varies, by the keys of the axes."""
    good = {name: row for name, row in rows.items() if row["results"]}
    along = abscissa(names, good) if good else None
    if not along or len({row["all"][along] for row in good.values()}) < 2:
        return ""
    drawn = []
    for column in columns_of(good):
        points = [(row["all"][along], v) for row in good.values() if is_number(v := row["results"].get(column)) and np.isfinite(v)]
        varies = points and all(len(set(side)) > 1 for side in zip(*points, strict=True))
        if varies and column not in ("physical time [s]", "mass drift"):
            drawn.append(line_chart(curves(names, varied, good, column, along), varied[along], column))
    return f'<div class="row">{"".join(drawn)}</div>'


def write_page(folder, scene, variant, names, varied, rows, words):
    """index.html of a sweep. names: keys of the axes; varied: all keys -> names of their columns. Returns its path."""
    columns = columns_of(rows)
    reasons = reasons_of(rows)
    lines = []
    for name, row in rows.items():
        said, color = status(row)
        lines.append([*(shown(row["all"][n]) for n in varied), Cell(link(folder, name, said, color), said),
                      *(row["results"].get(c) for c in columns), Cell(link(folder, name), name)])
    failed = sum(status(row)[1] == "bad" for row in rows.values())
    heading = f"{scene.name}{' ' + variant if variant else ''}: a sweep of {', '.join(names)}"
    text = page(heading, f"<h1>{html.escape(heading)}</h1>",
                f'<p class="soft">{html.escape(scene.heading())} · {len(rows)} runs, {failed} failed · '
                'the same as a table: <a href="sweep.csv">sweep.csv</a></p>',
                section("Curves", charts(names, varied, rows)),
                section("Runs", table([*varied.values(), "status", *columns, "run"], lines, sortable=True)),
                section("Reasons", table(["run", "status", "reason"], [
                    [Cell("<br>".join(link(folder, name) for name in names), names[0]), Cell(f'<span class="{color}">{said}</span>', said),
                     Cell(html.escape(reason), reason, "long")] for (said, color, reason), names in reasons.items()])
                    if reasons else "", f'<p class="soft">{OF_REFERENCES}</p>' if missed(rows) else ""),
                section("How to repeat it", f"<pre>{html.escape(repeated('sweep', words))}</pre>"))
    path = folder / "index.html"
    path.write_text(text)
    return path


def reasons_of(rows):
    """Runs that failed, missed a reference or were not judged, by status, colour and reason: those that failed come first."""
    found = {}
    for name, row in rows.items():
        if row["reason"]:
            found.setdefault((*status(row), row["reason"]), []).append(name)
    return dict(sorted(found.items(), key=lambda item: item[0][1] != "bad"))


def missed(rows):
    return any(row["code"] == OUT_OF_TOLERANCE for row in rows.values())


def link(folder, name, text=None, color=""):
    """To the page of a run, where it has one, else to its log. text: in place of its name."""
    target = f"{name}/index.html" if (folder / name / "index.html").exists() else f"logs/{name}.log"
    return f'<a href="{html.escape(target)}"{f" class={color}" if color else ""}>{html.escape(text or name)}</a>'
