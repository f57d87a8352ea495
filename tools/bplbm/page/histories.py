"""Curves against time that every run has: of its particles, bonds, obstacles, points, and of the fluid as a whole."""

import numpy as np

from bplbm.page.chart import Line, line_chart
from bplbm.page.sensors import felt
from bplbm.reading import read_table
from bplbm.written import unit_text

FEW = 6  # particles that have a curve each


def charts(run, planes):
    """SVG charts of a Run. planes: those of its frames, with the speeds of the fluid."""
    found = []
    for name, draw in (("probes", of_particles), ("breaks", of_breaks), ("obstacles", of_obstacles), ("points", of_points),
                       ("flow", of_flow)):
        path = run.folder / f"{name}.csv"
        if path.is_file() and path.read_text().count("\n") > 2:
            found += draw(read_table(path), run)
    if len(planes) > 2:
        time = [plane.time for plane in planes]
        mean, largest = np.transpose([plane.fluid for plane in planes])
        found.append(line_chart([Line("largest", time, largest), Line("mean", time, mean)], "time [s]",
                                "speed of the fluid [m/s]" if "box_z" not in run.parameters else "speed of the fluid, plane above [m/s]"))
    return found


def axes_of(table):
    return [axis for axis in "xyz" if axis in table]


def upward(table):
    return axes_of(table)[-1]


def of_particles(table, run):
    ids = np.unique(table["id"])
    return of_each(table, ids) if len(ids) <= FEW else of_all(table)


def particle_name(number):
    """As messages call it: numbers below -1 are clumps'."""
    family, count = divmod(-2 - int(number), 1 << 32) if number < -1 else (0, None)
    name = f"particle {number:.0f}" if count is None else f"clump {count + 1}"
    return f"{name} of the {family}. fix rigid" if family else name


def of_each(table, ids):
    """A curve a particle."""
    up = upward(table)
    mine = {i: table.where(table["id"] == i) for i in ids}
    name = lambda i: particle_name(i) if len(ids) > 1 else ""  # noqa: E731

    def chart(column, label):
        return line_chart([Line(name(i), t["time"], t[column]) for i, t in mine.items()], "time [s]", label)

    return [chart(up, f"height {up} [m]"), chart(f"v{up}", f"velocity in {up} [m/s]"),
            chart(f"f{up}", f"force of the fluid in {up} [N]")]


def of_all(table):
    """Sums, means and extremes over all particles at each time."""
    times, which = np.unique(table["time"], return_inverse=True)
    count = np.bincount(which)
    mean = lambda values: np.bincount(which, values) / count  # noqa: E731
    speed = np.sqrt(sum(table[f"v{a}"]**2 for a in axes_of(table)))
    fastest = np.zeros(len(times))
    np.maximum.at(fastest, which, speed)
    up = upward(table)
    drawn = [line_chart([Line("largest", times, fastest), Line("mean", times, mean(speed))], "time [s]",
                        "speed of the particles [m/s]"),
             line_chart([Line("", times, mean(table[up]))], "time [s]", f"mean height {up} [m]"),
             line_chart([Line(f"in {a}", times, np.bincount(which, table[f"f{a}"])) for a in axes_of(table)], "time [s]",
                        "force of the fluid on all [N]")]
    if len(set(count)) > 1:
        drawn.append(line_chart([Line("", times, count)], "time [s]", "particles"))
    return drawn


def of_breaks(table, run):
    """Steps of the count. The times are those of the fluid: what broke before it came has negative ones."""
    times = np.sort(table["time"])
    time = np.concatenate([[min(0.0, *times[:1])], np.repeat(times, 2), [max(run.summary["physical_seconds"], *times[-1:])]])
    count = np.concatenate([[0, 0], np.repeat(np.arange(1, len(times) + 1), 2)])
    return [line_chart([Line("", time, count[:len(time)])], "time [s]", "broken bonds")]


def of_flow(table, run):
    """The flow that a scene holds, and what drives it."""
    drive = next(column for column in table if column not in ("time", "flow", "wanted"))
    return [line_chart([Line(name, table["time"], table[name]) for name in ("flow", "wanted")], "time [s]", f"flow that is held [{unit_text(table.units['flow'])}]"),
            line_chart([Line("", table["time"], table[drive])], "time [s]", f"its {drive.replace('_', ' ')} [{unit_text(table.units[drive])}]")]


def of_obstacles(table, run):
    lines = [Line(f"obstacle {i:.0f}, {a}", one["time"], one[f"f{a}"])
             for i in np.unique(table["obstacle"])[:FEW] for one in [table.where(table["obstacle"] == i)]
             for a in "xyz" if f"f{a}" in table]
    turning = next((column for column in ("torque", "tz") if np.any(table.get(column, 0))), None)
    torques = [Line(f"obstacle {i:.0f}", one["time"], one[turning]) for i in np.unique(table["obstacle"])[:FEW]
               for one in [table.where(table["obstacle"] == i)]] if turning else []
    return [line_chart(lines, "time [s]", "force on obstacles [N]"),
            *([line_chart(torques, "time [s]", "torque on obstacles [N m]")] if torques else [])]


def of_points(table, run):
    axes = axes_of(table)
    places = np.unique(np.column_stack([table[a] for a in axes]), axis=0)[:FEW]
    here = lambda place: np.all([table[a] == v for a, v in zip(axes, place, strict=True)], axis=0)  # noqa: E731
    chosen = {", ".join(f"{v:.4g}" for v in place): table.where(here(place)) for place in places}
    velocities = [(column, f"velocity in {column[-1]} [m/s]") for column in felt(table, ["ux", "uy", "uz"])]
    return [line_chart([Line(f"at {name} m", t["time"], t[column]) for name, t in chosen.items()], "time [s]", label)
            for column, label in [("pressure", "pressure [Pa]"), *velocities]]
