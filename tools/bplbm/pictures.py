"""Drawing runs in one style."""

from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.colors import LogNorm
import matplotlib.pyplot as plt
import numpy as np

from bplbm.results import read_table, result

plt.rcParams.update({
    "figure.dpi": 130, "font.size": 9, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.alpha": 0.25, "legend.frameon": False, "lines.linewidth": 1.4,
})

UNITS = {1.0: "m", 1e-2: "cm", 1e-3: "mm"}
SPEED = plt.get_cmap("magma").with_extremes(bad="0.6")  # grey: no fluid


def speed_of_fluid(frame):
    """Of each cell; not a number where a solid covers it whole."""
    return np.where(np.isfinite(frame["pressure"]), np.linalg.norm(frame["velocity"], axis=-1), np.nan)


def draw_discs(axes, discs, particles):
    """Circles (x, y, radius); the discs of clumps, where there are any, without the lines inside of them."""
    discs = [plt.Circle((x, y), radius) for x, y, radius in discs if radius > 0]  # a clump's own row has none
    clumps = np.any(particles[:, 0] < -1)
    axes.add_collection(PatchCollection(discs, facecolor="white", edgecolor="black", linewidth=1.6 if clumps else 0.8))
    if clumps:
        axes.add_collection(PatchCollection(discs, facecolor="white", edgecolor="none"))


def draw_speed(axes, run, name, vmax, length_unit=1e-2):
    """Colour map of the fluid's speed with the particles on it, obstacles in grey. Returns the image."""
    frame = run.frame(name)
    p = run.parameters
    extent = [0, p["box_x"] / length_unit, 0, p["box_y"] / length_unit]
    image = axes.imshow(speed_of_fluid(frame), origin="lower", extent=extent, cmap=SPEED, vmin=0, vmax=vmax)
    draw_discs(axes, frame["particles"][:, 1:4] / length_unit, frame["particles"])
    axes.grid(False)
    return image


def draw_slice(axes, run, name, normal, at=None, vmax=None, length_unit=1e-2, quantity=None):
    """Colour map of the fluid's speed on a plane through a box in three dimensions, and the particles that it cuts.

    normal: x, y or z; at: where along it [m], the middle by default; quantity: [nz][ny][nx] instead of
    the speed. Returns the image.
    """
    frame, p = run.frame(name), run.parameters
    axis = "xyz".index(normal)
    across, up = [a for a in range(3) if a != axis]
    size = [p["box_x"], p["box_y"], p["box_z"]]
    at = 0.5 * size[axis] if at is None else at
    values = speed_of_fluid(frame) if quantity is None else quantity
    cells = values.shape[2 - axis]
    layer = np.take(values, min(cells - 1, int(at / size[axis] * cells)), axis=2 - axis)  # [up][across]
    extent = [0, size[across] / length_unit, 0, size[up] / length_unit]
    image = axes.imshow(layer, origin="lower", extent=extent, cmap=SPEED, vmin=0, vmax=vmax)
    particles = frame["particles"]
    depth = particles[:, 1 + axis] - at
    cut = np.abs(depth) < particles[:, 4]
    q = particles[cut]
    radii = np.sqrt(q[:, 4] ** 2 - depth[cut] ** 2)
    draw_discs(axes, np.column_stack([q[:, 1 + across], q[:, 1 + up], radii]) / length_unit, particles)
    axes.set_xlabel(f"{'xyz'[across]} [{UNITS[length_unit]}]")
    axes.set_ylabel(f"{'xyz'[up]} [{UNITS[length_unit]}]")
    axes.grid(False)
    return image


def draw_viscosity(axes, run, name, normal, limits=None, length_unit=1e-2):
    """draw_slice of the fluid's viscosity [Pa s] on a logarithmic scale, of a scene with output.viscosity."""
    viscosity = run.frame(name)["viscosity"] * run.parameters["density"]
    image = draw_slice(axes, run, name, normal, length_unit=length_unit, quantity=viscosity)
    image.set_norm(LogNorm(*(limits or (np.nanmin(viscosity), np.nanmax(viscosity)))))
    image.set_cmap("viridis")
    return image


def drag_results(run, others, drag, reference, source, drive, tolerance, fine_tolerance):
    """What is asked of an array of bodies at rest: its drag(run) at 10 and, where it has run, 20 cells, and that the force
    on its one body is `drive` [N], the force that drives the fluid. Tolerances are relative, at 10 and at 20 cells."""
    force = read_table(run.folder / "obstacles.csv")["fx"][-1]
    results = [result("drag", drag(run), "1", reference, source, tolerance),
               result("force over driving force", force / drive, "1", 1.0, "momentum balance of steady flow", 1e-4)]
    if "set-fine" in others:
        results.append(result("drag at 20 cells", drag(others["set-fine"]), "1", reference, source, fine_tolerance))
    return results


def draw_errors(axes, run, others, error, label):
    """Bars of error(run) [%] of a run and the comparison runs beside it, named after their overlays."""
    rows = {"default": run, "default, 20 cells": others.get("set-fine")}
    rows.update({name.removeprefix("variant-").replace("_", " "): r for name, r in others.items() if name != "set-fine"})
    rows = {name: error(r) for name, r in rows.items() if r}
    axes.barh(list(rows), list(rows.values()), color="tab:blue")
    room = 0.15 * max(10.0, max(rows.values()) - min(rows.values()))
    for i, value in enumerate(rows.values()):
        axes.text(max(value, 0) + 0.1 * room, i, f"{value:+.1f} %", va="center")
    axes.axvline(0, color="0.3", linewidth=0.8)
    axes.set_xlim(min(0, min(rows.values())) - room, max(0, max(rows.values())) + 1.6 * room)
    axes.set_xlabel(label)
    axes.invert_yaxis()


def draw_bonds(axes, frame, length_unit=1e-2):
    """Lines between bonded discs: intact green, broken by tension red, by shear blue (until the two have parted)."""
    if "bond_state" not in frame:
        return
    ends = frame["bond_ends"].reshape(-1, 2, 2) / length_unit
    for state, color, width in ((0, "tab:green", 0.8), (1, "tab:red", 1.4), (2, "tab:blue", 1.4)):
        axes.add_collection(LineCollection(ends[frame["bond_state"] == state], colors=color, linewidths=width))


def read_breaks(path):
    """Breaks of bonds: dict of step, time [s], pair [n][2] of ids, mode, place and normal [n][2] [m, 1]."""
    rows = [line.split(",") for line in path.read_text().splitlines()[1:]]

    def columns(*which):
        return np.array([[float(row[k]) for k in which] for row in rows]).reshape(-1, len(which))

    return {"step": columns(0)[:, 0].astype(int), "time": columns(1)[:, 0], "pair": columns(2, 3).astype(int),
            "mode": np.array([row[4] for row in rows], dtype=str), "place": columns(6, 7), "normal": columns(9, 10)}


def draw_breaks(axes, breaks, length_unit=1e-2, length=0.004):
    """A short line across each broken bond, where it broke: by tension red, by shear blue. length [m]."""
    along = breaks["normal"][:, ::-1] * [-0.5 * length, 0.5 * length]
    ends = np.stack([breaks["place"] - along, breaks["place"] + along], axis=1) / length_unit
    for mode, color in (("tension", "tab:red"), ("shear", "tab:blue")):
        axes.add_collection(LineCollection(ends[breaks["mode"] == mode], colors=color, linewidths=1.6))


def animate(run, name, draw, size, seconds=5.0):
    """A GIF of all field frames. draw(axes, time, frame_name) draws one on cleared axes."""
    frames = run.frames()
    figure, axes = plt.subplots(figsize=size)

    def step(i):
        axes.clear()
        draw(axes, *frames[i])

    FuncAnimation(figure, step, frames=len(frames)).save(
        run.folder / name, writer=PillowWriter(fps=max(1, round(len(frames) / seconds))), dpi=80)
    plt.close(figure)


def draw_snapshots(run, times, vmax, length_unit=1e-2, width=1.45):
    """A row of pictures of the fluid's speed at the frames nearest to the times [s], as field.png."""
    unit = UNITS[length_unit]
    frames = run.frames()
    chosen = [min(frames, key=lambda f: abs(f[0] - t)) for t in times if t <= 1.05 * frames[-1][0]]
    figure, axes = plt.subplots(1, len(chosen), figsize=(width * len(chosen) + 0.8, 4.2), sharey=True,
                                squeeze=False)
    for ax, (time, name) in zip(axes[0], chosen):
        image = draw_speed(ax, run, name, vmax, length_unit)
        ax.set_title(f"t = {time:.2f} s")
        ax.set_xlabel(f"x [{unit}]")
    axes[0][0].set_ylabel(f"y [{unit}]")
    figure.colorbar(image, ax=axes, label="speed of the fluid [m/s]", fraction=0.03, pad=0.02)
    run.save(figure, "field.png")
