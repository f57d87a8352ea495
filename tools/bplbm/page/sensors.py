"""Curves of a scene's sensors, and pictures of its averages. A run without them costs a look into its folder."""

import h5py
import numpy as np

from bplbm.page.chart import COLORS, Line, line_chart
from bplbm.page.html import table as html_table
from bplbm.page.picture import HOT, TWO_SIDED, Scale, coarser, data_url, png
from bplbm.reading import read_table
from bplbm.written import unit_text

PROFILES = 5  # times of a line that are drawn
PART = 1e-3  # a component that is smaller than this part of the largest one is not drawn
AVERAGES = {"velocity_mean": ("speed of the mean velocity", "m/s"), "velocity_rms": ("fluctuation of the velocity (rms)", "m/s"),
            "pressure_mean": ("mean pressure", "Pa"), "pressure_rms": ("fluctuation of the pressure (rms)", "Pa")}


def read_sensors(run):
    """Tables of a Run's sensors that hold rows: dict name -> Table."""
    tables = {path.stem.removeprefix("sensor-"): read_table(path) for path in sorted(run.folder.glob("sensor-*.csv"))}
    return {name: table for name, table in tables.items() if len(table["time"])}


def kind_of(table):
    """line, plane or side, by the columns."""
    return "line" if "distance" in table else "plane" if "fluid_area" in table else "side"


def charts(run):
    """SVG charts of all sensors of a Run; an empty list without any."""
    tables = read_sensors(run)
    of_kind = lambda *kinds: {name: t for name, t in tables.items() if kind_of(t) in kinds}  # noqa: E731
    across, planes, sides = of_kind("plane", "side"), of_kind("plane"), of_kind("side")
    changing = {name: t for name, t in planes.items() if np.ptp(t["fluid_area"]) > PART * np.max(t["fluid_area"])}
    return [*against_time(across, ["flow"], "flow"), *against_time(planes, ["pressure"], "mean pressure on planes"),
            *against_time(planes, [f"momentum_{a}" for a in "xyz"], "momentum through planes"),
            *against_time(changing, ["fluid_area"], "fluid on planes"),
            *against_time(sides, [f"f{a}" for a in "xyz"], "force on sides"),
            *[chart for name, t in of_kind("line").items() for chart in of_line(name, t)]]


def felt(table, columns):
    """Those of some columns that a table has, and that are not nothing beside the largest of them."""
    largest = {c: np.nanmax(np.abs(table[c]), initial=0.0) for c in columns if c in table}
    return [c for c, value in largest.items() if value >= PART * max(largest.values())]


def against_time(tables, columns, label):
    """Charts of some columns of tables, at most as many lines each as there are colours."""
    lines, unit = [], "1"
    for name, table in tables.items():
        for column in felt(table, columns):
            which = f"{name}, {column[-1]}" if len(columns) > 1 else name
            lines.append(Line(which, table["time"], table[column]))
            unit = unit_text(table.units[column])
    return [line_chart(lines[k:k + len(COLORS)], "time [s]", f"{label} [{unit}]") for k in range(0, len(lines), len(COLORS))]


def of_line(name, table):
    """Profiles along a line at some times, and the mean along it against time."""
    times = np.unique(table["time"])
    shown = times[np.unique(np.linspace(0, len(times) - 1, PROFILES).round().astype(int))]
    drawn = []
    for column in [*felt(table, ["ux", "uy", "uz"]), "pressure"]:
        what = f"{name}: {'pressure' if column == 'pressure' else f'velocity in {column[-1]}'} [{unit_text(table.units[column])}]"
        rows = [table.where(table["time"] == t) for t in shown]
        drawn.append(line_chart([Line(f"{t:.4g} s", r["distance"], r[column]) for t, r in zip(shown, rows, strict=True)],
                                "distance along the line [m]", what))
        if len(times) > 2:
            drawn.append(line_chart([Line("", times, mean_at(times, table["time"], table[column]))], "time [s]", f"mean along {what}"))
    return drawn


def mean_at(times, time, values):
    """Mean of the finite values at each time; not a number where there is none."""
    where, good = np.searchsorted(times, time), np.isfinite(values)
    count = np.bincount(where[good], minlength=len(times))
    total = np.bincount(where[good], values[good], minlength=len(times))
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def plane_of(data):
    """The field in two dimensions, or its middle plane normal to y in three, the length of a vector; [up][across]."""
    components = data.shape[-1] == 3 and data.name.startswith("/velocity")
    values = data[:, data.shape[1] // 2] if data.ndim - components == 3 else data[...]
    return np.linalg.norm(values.astype(float), axis=-1) if components else values.astype(float)


def averages(run):
    """HTML of pictures of averages.h5 and a table of their means and largest values; nothing where there is no such file."""
    path = run.folder / "averages.h5"
    if not path.is_file():
        return []
    with h5py.File(path) as file:
        fields = {name: plane_of(file[name]) for name in AVERAGES if name in file}
        flat = file[next(iter(fields))].ndim == (3 if next(iter(fields)).startswith("velocity") else 2)
        about = f"{file.attrs['samples']:.0f} samples from {file.attrs['from']:.4g} s to {file.attrs['to']:.4g} s"
    fluid = np.isfinite(fields["pressure_mean"]) if "pressure_mean" in fields else True
    fields = {name: np.where(fluid, values, np.nan) for name, values in fields.items()}
    where = "" if flat else ", in the middle plane of y"
    rows = [[AVERAGES[name][0], float(np.nanmean(v)), float(np.nanmax(v)), AVERAGES[name][1]]
            for name, v in fields.items() if np.isfinite(v).any()]
    return [f'<p class="soft">{about}{where}; grey: no fluid</p>',
            f'<div class="row">{"".join(picture_of(name, values) for name, values in fields.items())}</div>',
            html_table(["average", "mean", "largest", "unit"], rows)]


def picture_of(name, values):
    """A field [up][across] as a picture with its colours."""
    title, unit = AVERAGES[name]
    finite = values[np.isfinite(values)]
    high = float(finite.max(initial=0.0))
    scale = Scale(0.0, high or 1.0, HOT)
    if finite.min(initial=0.0) < 0.0:
        reach = float(np.abs(finite).max())
        scale = Scale(-reach, reach, TWO_SIDED)
    ratio = values.shape[1] / values.shape[0]
    return (f'<figure style="width:{max(220, min(420, 300 * ratio)):.0f}px"><img alt="{title}" style="width:{min(420, 300 * ratio):.0f}px;'
            f'image-rendering:pixelated" src="{data_url(png(scale.indices(coarser(values))[::-1], scale.palette()))}">'
            f"{scale.bar(f'{title} [{unit}]')}</figure>")
