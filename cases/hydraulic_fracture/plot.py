"""Results, pictures and animation of hydraulic_fracture. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, animate, draw_bonds, draw_speed, quantity, read_breaks, read_table, result, studies, write_table
from bplbm.cracks import BondGraph, openings
from bplbm.pores import cavity, pressure_at

INLET = (0.0475, 0.0525)  # m: heights of the slot in the left wall
REACH = 0.007  # m: 1.5 diameters; a crack begins with a break as near as that to the inlet or the notch
SNAPSHOTS = (0.003, 0.005, 0.008)  # s


class Fracture:
    """The breaks of a run, and which of them are the crack from the inlet."""

    def __init__(self, run):
        self.run, self.frames = run, run.frames()
        self.breaks = read_breaks(run.folder / "breaks.csv")
        self.time, self.place = self.breaks["time"], self.breaks["place"]
        normal = self.breaks["normal"]
        # direction of the crack from the x axis, across the bond [degrees, -90 … 90]
        self.angle = (np.degrees(np.arctan2(normal[:, 1], normal[:, 0])) + 180) % 180 - 90
        self.graph, self.radii = graph_of(run, self.frames)
        self.notch = self.notch_length()  # summary.json does not know it
        self.crack = self.crack_until(np.inf)

    def notch_length(self):
        """How far from the inlet no bond crosses its height [m]."""
        if not self.graph:
            return 0.0
        middle = np.mean(INLET)
        ends = np.array([[self.graph.places[a], self.graph.places[b]] for a, b in self.graph.pairs])
        over = (ends[:, 0, 1] - middle) * (ends[:, 1, 1] - middle) < 0
        return max(0.0, ends[over][..., 0].mean(axis=1).min() - REACH / 3)

    def crack_until(self, time):
        """Numbers of the breaks that are the crack from the inlet at a time [s]."""
        known = np.flatnonzero(self.time <= time)
        if not self.graph or not len(known):
            return np.zeros(0, dtype=int)
        apart = self.place[known] - np.stack([np.clip(self.place[known, 0], 0.0, self.notch),
                                              np.clip(self.place[known, 1], *INLET)], axis=1)
        return known[self.graph.crack(self.breaks["pair"][known], np.hypot(*apart.T) < REACH)]

    def size(self, crack):
        """How far a crack reaches from the inlet, and how high it is [m]."""
        if not len(crack):
            return 0.0, 0.0
        return self.place[crack, 0].max(), np.ptp(self.place[crack, 1])

    def opening(self, name, crack):
        """Gaps of a frame at the breaks of a crack [m]."""
        if not len(crack):
            return np.zeros(0)
        particles = self.run.frame(name)["particles"]
        places = dict(zip(particles[:, 0].astype(int), particles[:, 1:3]))
        return openings(places, self.radii, self.breaks["pair"][crack])

    def inflow(self, frame):
        """Through the inlet: volume a time [m³/s, 1 m deep], and the work that its pressure does [W]."""
        cell = self.run.parameters["cell"]
        rows = slice(round(INLET[0] / cell), round(INLET[1] / cell))
        flux = np.nan_to_num(frame["velocity"][rows, 0, 0]) * cell
        return flux.sum(), (flux * np.nan_to_num(frame["pressure"][rows, 0])).sum()

    def energies(self, times):
        """Of the bonds and contacts at times [s], from the coming of the water on: dict of arrays [J]."""
        table = read_table(self.run.folder / "energy.csv")  # a restart adds a row of nan, and repeats what came after it
        rows = np.flatnonzero(np.isfinite(table["time"]))
        rows = rows[len(rows) - 1 - np.unique(table["time"][rows][::-1], return_index=True)[1]]
        return {f"{key}_energy": np.interp(times, table["time"][rows], table[key][rows] - table[key][rows[0]])
                for key in ("elastic", "friction", "damping", "released")}

    def history(self):
        """Columns against time, one row a frame."""
        rows = []
        for time, name in self.frames:
            crack, frame = self.crack_until(time), self.run.frame(name)
            length, height = self.size(crack)
            gaps, known = self.opening(name, crack), self.time <= time
            rows.append({"time": time, "bonds_broken": known.sum(),
                         "by_tension": (known & (self.breaks["mode"] == "tension")).sum(),
                         "cracks_within_45_degrees_of_the_horizontal": (known & (np.abs(self.angle) < 45)).sum(),
                         "bonds_of_the_crack": len(crack), "length": length, "height": height,
                         "aperture": gaps.mean() if len(gaps) else 0.0,
                         "pressure_in_the_crack": pressure_at(self.run, frame, self.place[crack]),
                         "cavity": cavity(self.run, frame, INLET),
                         "crack_volume": gaps.sum() * 2 * np.mean(list(self.radii.values())),
                         "inflow": self.inflow(frame)[0], "power": self.inflow(frame)[1]})
        table = {key: np.array([row[key] for row in rows]) for key in rows[0]}
        table["water_in"], table["work_of_the_inflow"] = (summed(table["time"], table.pop(key)) for key in ("inflow", "power"))
        table["leak_off"] = table["water_in"] - table["crack_volume"]
        return table | self.energies(table["time"])


def summed(time, rate):
    """Integral of a rate from the first time on, by the trapezoidal rule."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))])


def graph_of(run, frames):
    """The bonds as they were made, and radii by id; None where there are none."""
    for _, name in frames:
        frame = run.frame(name)
        particles = frame["particles"]
        radii = dict(zip(particles[:, 0].astype(int), particles[:, 3]))
        if "bond_ends" in frame and len(frame["bond_ends"]):
            break
    else:
        return None, radii
    ids, centres, ends = particles[:, 0].astype(int), particles[:, 1:3], frame["bond_ends"]
    nearest = ids[np.argmin(np.hypot(*(ends[:, None] - centres[None]).transpose(2, 0, 1)), axis=1)]
    return BondGraph(dict(zip(ids, centres)), nearest.reshape(-1, 2)), radii


def pressures(fracture):
    """Mean pressures at the end in the notch, and in the ground more than 20 mm above and below it, 10 … 50 mm deep [Pa]."""
    run = fracture.run
    pressure, cell, middle = run.frame(fracture.frames[-1][1])["pressure"], run.parameters["cell"], np.mean(INLET)
    x, y = (cell * (np.arange(n) + 0.5) for n in pressure.shape[::-1])
    notch = np.ix_(np.abs(y - middle) < 0.002, (x > 0.001) & (x < max(0.005, fracture.notch)))
    ground = np.ix_(np.abs(y - middle) > 0.02, (x > 0.01) & (x < 0.05))
    return np.nanmean(pressure[notch]), np.nanmean(pressure[ground])


def judge(fracture, history):
    """What the paper's picture says: horizontal, from the inlet, growing, by tension."""
    length, height = fracture.size(fracture.crack)
    paper = "Wang, Feng and Wang 2016: "
    growth = np.diff(history["length"])
    tension = (fracture.breaks["mode"] == "tension").mean()
    longest = min(1.0, length / max(2.0 * height, 1e-9))
    return [result("length over twice the height, at most 1", longest, "1", 1.0, paper + "a horizontal fracture", 0.0),
            result("broken by tension", tension, "1", 1.0, paper + "the fracture opens", 0.2),
            result("part of the breaks in the crack from the inlet", len(fracture.crack) / len(fracture.time), "1", 1.0,
                   paper + "the fracture grows from the pipe", 0.6),
            result("steps in which the crack became shorter", (growth < 0).sum(), "1", 0.0, "a crack does not heal", 0.0,
                   scale=1.0),
            result("growth beyond the notch over two diameters, at most 1",
                   min(1.0, (length - fracture.notch) / 0.009), "1", 1.0, paper + "the fracture grows gradually", 0.0)]


def quantities(fracture, history):
    length, height = fracture.size(fracture.crack)
    first = fracture.time[0] if len(fracture.time) else np.nan
    return [quantity("bonds broken", len(fracture.time), "1"),
            quantity("of them in the crack", len(fracture.crack), "1"),
            quantity("cracks within 45° of the horizontal", (np.abs(fracture.angle) < 45).sum(), "1"),
            quantity("first break", first, "s"), quantity("length of the crack, with the notch", length, "m"),
            quantity("height of the crack", height, "m"), quantity("mean aperture", history["aperture"][-1], "m"),
            quantity("pressure in the crack", history["pressure_in_the_crack"][-1], "Pa"),
            quantity("pressure in the notch", pressures(fracture)[0], "Pa"),
            quantity("pressure in the ground", pressures(fracture)[1], "Pa"),
            *(quantity(name, history[key][-1], unit) for name, key, unit in (
                ("water pressed in, a metre of depth", "water_in", "m³"), ("of it leaked off", "leak_off", "m³"),
                ("work of the inflow", "work_of_the_inflow", "J"), ("elastic energy gained", "elastic_energy", "J"),
                ("energy released by breaking bonds", "released_energy", "J"),
                ("energy lost to friction", "friction_energy", "J"), ("energy lost to damping", "damping_energy", "J"))),
            quantity("wide cavity at the inlet", history["cavity"][-1], "m²"),
            quantity("Ma = u/c_s", fracture.run.summary["ma_max"], "1")]


def draw(axes, fracture, time, name):
    run, frame = fracture.run, fracture.run.frame(name)
    image = draw_speed(axes, run, name, 10.0, length_unit=1e-3)
    draw_bonds(axes, frame, length_unit=1e-3)
    crack = fracture.crack_until(time)
    axes.plot(*(1e3 * fracture.place[crack].T), "o", markersize=5, markerfacecolor="none", color="gold")
    axes.set_title(f"t = {time * 1e3:.1f} ms")
    axes.set_xlabel("x [mm]")
    return image


def draw_pressure(axes, fracture, name):
    """Map of the water's pressure: the crack is filled."""
    run, frame = fracture.run, fracture.run.frame(name)
    size = 1e3 * run.parameters["box_x"]
    image = axes.imshow(1e-3 * frame["pressure"], origin="lower", extent=[0, size, 0, size], cmap="viridis", vmin=0, vmax=600)
    axes.grid(False)
    axes.set_xlabel("x [mm]")
    return image


def snapshots(fractures):
    columns = len(SNAPSHOTS) + 1
    figure, axes = plt.subplots(len(fractures), columns, figsize=(2.9 * columns, 2.8 * len(fractures)), squeeze=False,
                                sharex=True, sharey=True, layout="constrained", dpi=90)
    for row, (label, f) in zip(axes, fractures.items()):
        for ax, wanted in zip(row, SNAPSHOTS):
            speed = draw(ax, f, *min(f.frames, key=lambda frame: abs(frame[0] - wanted)))
        time, name = f.frames[-1]
        pressure = draw_pressure(row[-1], f, name)
        row[-1].set_title(f"t = {1e3 * time:.1f} ms")
        row[0].set_ylabel(f"{label}\ny [mm]")
    figure.colorbar(speed, ax=axes[:, 0], label="speed of the water [m/s]", location="left", fraction=0.05)
    figure.colorbar(pressure, ax=axes[:, -1], label="pressure [kPa]", fraction=0.05)
    next(iter(fractures.values())).run.save(figure, "field.png")


def rose(axes, fracture):
    """Directions of the crack's breaks against those of the others."""
    edges = np.radians(np.arange(-90, 91, 15))
    mine = np.isin(np.arange(len(fracture.angle)), fracture.crack)
    below = np.zeros(len(edges) - 1)
    for chosen, label in ((mine, "crack"), (~mine, "elsewhere")):
        count = np.histogram(np.radians(fracture.angle[chosen]), edges)[0]
        axes.bar(edges[:-1], count, width=np.diff(edges), bottom=below, align="edge", label=label)
        below = below + count
    axes.set_thetamin(-90)
    axes.set_thetamax(90)
    axes.legend(fontsize=7, loc="upper right", bbox_to_anchor=(0.45, 0.95))
    axes.set_title("directions of the breaks", fontsize=9)


def draw_history(fractures, histories, run):
    figure = plt.figure(figsize=(13.5, 3.0))
    left, middle, right = (figure.add_subplot(1, 4, k) for k in (1, 2, 3))
    colors = plt.get_cmap("tab20").colors
    for color, (label, f) in zip(colors, fractures.items()):
        h = histories[label]
        left.plot(1e3 * h["time"], 1e3 * h["length"], color=color, label=label)
        middle.step(1e3 * f.time, np.arange(1, len(f.time) + 1), color=color)
        right.plot(1e3 * h["time"], 1e6 * h["cavity"], color=color)
    left.set_ylabel("crack with notch [mm]")
    middle.set_ylabel("bonds broken")
    right.set_ylabel("cavity at the inlet [mm²]")
    for ax in (left, middle, right):
        ax.set_xlabel("time [ms]")
        ax.set_xlim(0, 8)
    left.legend(fontsize=5.5, loc="upper left")
    rose(figure.add_subplot(1, 4, 4, projection="polar"), next(iter(fractures.values())))
    figure.tight_layout()
    run.save(figure, "history.png")


def draw_energy(history, run):
    """Where the water and its work go, of one run."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 2.8), layout="constrained")
    time = 1e3 * history["time"]
    for key, label in (("work_of_the_inflow", "work of the inflow"), ("elastic_energy", "springs"),
                       ("damping_energy", "damping"), ("released_energy", "broken bonds"),
                       ("friction_energy", "friction")):
        left.plot(time, history[key], label=label)
    left.set(xlabel="time [ms]", ylabel="energy [J/m]", yscale="log", ylim=(1e-2, None))
    for key, label in (("water_in", "pressed in"), ("leak_off", "leaked off"), ("crack_volume", "in the crack")):
        right.plot(time, 1e6 * history[key], label=label)
    right.set(xlabel="time [ms]", ylabel="water [cm³/m]")
    for ax in (left, right):
        ax.legend(fontsize=7)
    run.save(figure, "energy.png")


def note(label, fracture, history):
    length, height = (1e3 * value for value in fracture.size(fracture.crack))
    text = f"{len(fracture.time)} bonds broken"
    if len(fracture.time):
        text += (f" ({(fracture.breaks['mode'] == 'tension').mean():.0%} by tension), the first at "
                 f"{fracture.time[0] * 1e3:.1f} ms; {len(fracture.crack)} are a crack from the inlet, {length:.0f} mm long with "
                 f"the notch and {height:.0f} mm high, open {1e6 * history['aperture'][-1]:.0f} µm")
    print(f"run | note | {label}: {text}; wide cavity {1e6 * history['cavity'][-1]:.0f} mm²; Ma = u/c_s "
          f"{fracture.run.summary['ma_max']:.2f}")


def main():
    run = Run(sys.argv[1])
    runs = {run.summary["variant"] or "default": run}
    runs.update({name.removeprefix("variant-"): r for name, r in studies(run).items()})
    fractures = {label: Fracture(r) for label, r in runs.items()}
    histories = {label: f.history() for label, f in fractures.items()}
    first = next(iter(fractures))
    judged = first == "default" and run.summary["set"] == "resolved" and run.summary["physical_seconds"] > 0.0079
    run.write_results(judge(fractures[first], histories[first]) if judged else [],
                      quantities(fractures[first], histories[first]))
    write_table(run.folder / "history.csv", histories[first])
    for label, f in fractures.items():
        note(label, f, histories[label])
    shown = [label for label in (first, "granular", "cloud") if label in fractures]
    snapshots({label: fractures[label] for label in dict.fromkeys(shown)})
    draw_history(fractures, histories, run)
    draw_energy(histories[first], run)
    animate(run, "animation.gif", lambda ax, t, name: draw(ax, fractures[first], t, name), (4.2, 4.2))


if __name__ == "__main__":
    main()
