"""Results and pictures of critical_gradient. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, quantity, read_table, result, studies

FLOOR = 0.004         # m, of the scene
# The bed lifts where its effective stress vanishes. While it rests, the floor's load falls in a straight line with the
# gradient; that line is followed to zero, since a few discs stay behind on the floor when the bed has lifted.
LINE = (0.1, 0.5)     # of the submerged weight, part of the line that is used
# The balance of momentum is exact. What is left is the inertia of the fluid during the ramp, which the pressures
# hold by some tenths of a per cent.
TOLERANCE = 0.02
REST = (0.2, 0.35)    # s: the bed has come to rest in the fluid, and the drive carries a tenth at most
# The weight at rest is a mean over the last swings of the bed, which are 2 % of it.
REST_TOLERANCE = 0.01
SEEPAGE = (0.6, 0.95)  # of the critical gradient: where the permeability is measured
# Until it lifts, the bed rises by what its contacts give way, weight / stiffness for each of some
# fifteen layers: 0.03 mm. A tenth of a disc is far above that.
ELASTIC = 0.1         # of a disc's diameter
# Fluid and discs, 56 kg over each square metre of floor, take a moment to get into motion: the surplus of 10 %
# that the ramp reaches 0.1 s after the lift-off has moved them by some two such distances.
BRACKET = (0.95, 1.1)


class Bed:
    """The bed of one run: its history, and the numbers of soil mechanics."""

    def __init__(self, run):
        self.run, p = run, run.parameters
        self.unit_weight = p["density"] * -p["gravity_y"]  # of the fluid [N/m³]
        self.relative_density = p["particle_density"] / p["density"]
        self.frame = run.frame(run.frames()[0][1])
        discs = self.frame["particles"]
        self.radius = discs[np.argsort(discs[:, 0]), 3]
        area = np.pi * self.radius**2
        self.area = area.sum()
        self.times, centre = self.history(area)
        rest = centre[self.resting(self.times)].mean()
        self.rise = centre - rest
        self.height = 2 * (rest - FLOOR)  # of an even bed with this centre of gravity [m]
        self.solid = self.area / (p["box_x"] * self.height)  # 1 - n
        self.weight = self.area * p["depth"] * (p["particle_density"] - p["density"]) * -p["gravity_y"]
        self.reference = self.solid * (self.relative_density - 1)
        points = read_table(run.folder / "points.csv")
        low = points["y"] < FLOOR
        self.drive_times = points["time"][low]
        self.gradients = (points["pressure"][low] - points["pressure"][~low]) / (self.unit_weight * self.height)
        floor = read_table(run.folder / "floor.csv")
        self.floor_times, self.floor = floor["time"], floor["force"] / self.weight
        self.find_lift_off()

    def history(self, area):
        """Times, and height of the bed's centre of gravity [m]."""
        probes = read_table(self.run.folder / "probes.csv")
        order = np.lexsort((probes["id"], probes["time"]))
        times = np.unique(probes["time"])
        return times, probes["y"][order].reshape(len(times), len(area)) @ area / area.sum()

    @staticmethod
    def resting(times):
        return (times >= REST[0]) & (times <= REST[1])

    def gradient(self, times):
        """Hydraulic gradient over the bed, from the pressures below and above it."""
        return np.interp(times, self.drive_times, self.gradients)

    def find_lift_off(self):
        """Gradient at which the straight line of the floor's load reaches zero, and when; of a bed that never lifts the
        largest gradient, at the end."""
        gradients = self.gradient(self.floor_times)
        chosen = (self.floor > LINE[0]) & (self.floor < LINE[1]) & (self.floor_times > REST[1])
        self.critical, self.lift_off = self.gradients[-1], self.times[-1]
        if self.floor.min() > LINE[0] or chosen.sum() < 2:
            return
        slope, at_rest = np.polyfit(gradients[chosen], self.floor[chosen], 1)
        reached = np.flatnonzero((gradients >= -at_rest / slope) & (self.floor_times > REST[1]))
        if len(reached):
            self.critical, self.lift_off = -at_rest / slope, self.floor_times[reached[0]]

    def rise_at(self, gradient):
        """Rise [m] at the first moment at which the gradient is reached; nan if it never is."""
        reached = np.flatnonzero((self.gradient(self.times) >= gradient) & (self.times > REST[1]))
        return self.rise[reached[0]] if len(reached) else np.nan

    def floor_at(self, time):
        """Mean over the 20 ms around it: the rattling of single discs is faster."""
        return self.floor[np.abs(self.floor_times - time) < 0.01].mean()

    def floor_at_rest(self):
        """What the floor bears of the submerged weight, with what the drive already carries put back."""
        chosen = self.resting(self.floor_times)
        return np.mean(self.floor[chosen] + self.gradient(self.floor_times[chosen]) / self.reference)

    def ratio(self):
        """Radius that the flow sees over the disc's, from the area that is covered on the grid."""
        return np.sqrt(self.frame["solid_fraction"].sum() * self.run.parameters["cell"] ** 2 / self.area)

    def permeability(self):
        """k = nu q / (g i) [m²] with the flow q that leaves through the top, relative to the discs."""
        p, found = self.run.parameters, []
        for time, name in self.run.frames():
            gradient = self.gradient(time)
            if not SEEPAGE[0] < gradient / self.reference < SEEPAGE[1] or time < REST[1]:
                continue
            frame = self.run.frame(name)
            top = (frame["particles"][:, 2] + frame["particles"][:, 3]).max()
            row = int(top / p["cell"]) + 5  # clear of the discs
            flow = frame["velocity"][row, :, 1].mean() - frame["particles"][:, 5].mean()
            found.append(p["kinematic_viscosity"] * flow / (-p["gravity_y"] * gradient))
        return np.mean(found)

    def kozeny_carman(self):
        """k = n³ / (5 S² (1-n)²), S = 4/d the surface of a disc over its area, of the discs that the flow sees."""
        ratio = self.ratio()
        d = ratio * 2 * (self.radius**2).sum() / self.radius.sum()
        solid = self.solid * ratio**2
        return (1 - solid) ** 3 * d**2 / (80 * solid**2)


def judged(bed):
    name = f"hydraulic ratio {bed.ratio():.1f}: "
    below, above = (bed.rise_at(part * bed.reference) for part in BRACKET)
    diameter = 2 * bed.radius.mean()
    return [
        result(name + "weight on the floor at rest over the submerged weight", bed.floor_at_rest(), "1", 1.0,
               "Archimedes", REST_TOLERANCE),
        result(name + "critical gradient", bed.critical, "1", bed.reference,
               "balance of momentum: (1-n)(G_s-1), Terzaghi", TOLERANCE),
        result(name + "bed lies at 0.95 of it and has moved at 1.10", below < ELASTIC * diameter < above, "yes", 1,
               "balance of momentum", 0)]


def quantities(bed):
    name = f"hydraulic ratio {bed.ratio():.1f}: "
    p = bed.run.parameters
    k, expected = bed.permeability(), bed.kozeny_carman()
    conductivity = -p["gravity_y"] / p["kinematic_viscosity"]
    return [quantity(name + "porosity n", 1 - bed.solid, "1"),
            quantity(name + "porosity that the flow sees", 1 - bed.solid * bed.ratio() ** 2, "1"),
            quantity(name + "height of the bed", bed.height, "m"),
            quantity(name + "time of lift-off", bed.lift_off, "s"),
            quantity(name + "load of the floor at lift-off over the submerged weight", bed.floor_at(bed.lift_off), "1"),
            quantity(name + "permeability k", k, "m²"),
            quantity(name + "permeability by Kozeny-Carman for discs, an orientation", expected, "m²"),
            quantity(name + "hydraulic conductivity K", k * conductivity, "m/s")]


def picture_history(beds, run):
    figure, (top, middle, bottom) = plt.subplots(3, 1, figsize=(6.4, 6.6), sharex=True)
    for (color, style), (label, bed) in zip((("tab:blue", "-"), ("tab:orange", "--")), beds.items()):
        top.plot(bed.times, bed.gradient(bed.times), style, color=color, label=label)
        top.plot(bed.lift_off, bed.critical, "o", color=color)
        middle.plot(bed.floor_times[::10], bed.floor[::10], style, color=color)
        bottom.plot(bed.times, 1e3 * bed.rise, style, color=color)
        for ax in (middle, bottom):
            ax.axvline(bed.lift_off, color=color, linewidth=0.8, linestyle=":")
    first = next(iter(beds.values()))
    top.axhline(first.reference, color="0.4", linewidth=0.9, linestyle="-.", label="(1-n)(G_s-1)")
    top.set_ylabel("hydraulic gradient i")
    top.legend()
    middle.axhline(1, color="0.4", linewidth=0.9, linestyle="-.")
    middle.set_ylim(-0.1, 1.3)
    middle.set_ylabel("weight on the floor /\nsubmerged weight")
    bottom.set_ylim(-0.1, 2.0)
    bottom.set_ylabel("rise of the bed's\ncentre of gravity [mm]")
    bottom.set_xlabel("time [s]")
    figure.tight_layout()
    run.save(figure, "history.png")


def draw_pressure(axes, bed, name, largest):
    """Colour map of the excess pressure; discs as circles, filled as far as the flow sees them. Returns the image."""
    frame, p, ratio = bed.run.frame(name), bed.run.parameters, bed.ratio()
    edge = "white" if ratio < 0.99 else "0.5"
    image = axes.imshow(frame["pressure"], origin="lower", extent=[0, 1e3 * p["box_x"], 0, 1e3 * p["box_y"]],
                        cmap="viridis", vmin=0, vmax=largest, interpolation="nearest")
    for _, x, y, radius, *_ in frame["particles"]:
        for image_of in (-1, 0, 1):  # through the periodic sides
            at = (1e3 * (x + image_of * p["box_x"]), 1e3 * y)
            axes.add_patch(plt.Circle(at, 1e3 * radius * ratio, facecolor="white", edgecolor="none"))
            axes.add_patch(plt.Circle(at, 1e3 * radius, facecolor="none", edgecolor=edge, linewidth=0.5))
    axes.axhline(1e3 * FLOOR, color="tab:red", linewidth=1.2, linestyle="--")
    axes.set_xlim(0, 1e3 * p["box_x"])
    axes.set_ylim(0, 1e3 * p["box_y"])
    axes.set_xlabel("x [mm]")
    axes.grid(False)
    return image


def picture_field(beds, run):
    """The beds at rest, about to lift, and at the end."""
    figure, axes = plt.subplots(len(beds), 3, figsize=(8.2, 4.6 * len(beds)), sharey=True, squeeze=False)
    for row, (label, bed) in zip(axes, beds.items()):
        frames = bed.run.frames()
        for ax, wanted in zip(row, (0.6, 1.2, frames[-1][0])):
            time, name = min(frames, key=lambda f: abs(f[0] - wanted))
            image = draw_pressure(ax, bed, name, 140.0)
            ax.set_title(f"t = {time:.2f} s, i = {bed.gradient(time):.2f}")
        row[0].set_ylabel(f"{label}\ny [mm]")
    figure.colorbar(image, ax=axes, label="excess pressure of the fluid [Pa]", fraction=0.04, pad=0.02)
    run.save(figure, "field.png")


def main():
    run = Run(sys.argv[1])
    beds = [Bed(r) for r in (run, *studies(run).values())]
    run.write_results([r for bed in beds for r in judged(bed)], [q for bed in beds for q in quantities(bed)])
    named = {f"hydraulic ratio {bed.ratio():.1f}": bed for bed in beds}
    for q in run.summary["quantities"]:
        print(f"run | note | {q['name']} = {q['value']:.4g} {q['unit']}")
    picture_history(named, run)
    picture_field(named, run)


if __name__ == "__main__":
    main()
