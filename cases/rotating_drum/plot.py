"""Results and pictures of rotating_drum. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_speed, quantity, read_table, result, studies

CENTRE, RADIUS, SPIN = 0.0384, 0.030, 1.0  # m, m, rad/s
BEGIN = 1.0                                # s: the bed has been lifted to where it flows
GRAVITY = 9.81
AVALANCHE = 3.0                            # degrees by which the bed falls or rises at least


class Bed:
    """What the script wrote of the grains: torques and moments per metre of depth [N m/m], angles [degrees]."""

    def __init__(self, run):
        p = run.parameters
        step, torque, mx, my, turn = np.loadtxt(run.folder / "drum.txt", ndmin=2).T
        end = read_table(run.folder / "probes.csv")["time"].max()
        self.times = step / step[-1] * end
        late = self.times > BEGIN
        weight = (1 - p["density"] / p["particle_density"]) * GRAVITY / p["depth"]  # of a kilogram of grains in the liquid
        loads = read_table(run.folder / "obstacles.csv")
        self.on_grains = torque[late].mean() / p["depth"]
        self.on_liquid = -loads["torque"][loads["time"] > BEGIN].mean() / p["depth"]
        self.moment = weight * mx[late].mean()
        gained = (turn[late][-1] - turn[late][0]) / np.ptp(self.times[late]) / p["depth"]
        self.balance = (self.on_grains + self.on_liquid - gained) / self.moment
        self.history = np.degrees(np.arctan2(mx, -my))  # a half disc of grains, seen from the axis: the slope of its surface
        self.angles = self.history[late]

    def avalanches(self):
        """Angles at which the bed began to flow, and at which it came to rest."""
        ends, rising, extreme = {True: [], False: []}, True, self.angles[0]
        for angle in self.angles:
            sign = 1 if rising else -1
            if sign * (angle - extreme) > 0:
                extreme = angle
            elif sign * (extreme - angle) > AVALANCHE:
                ends[rising].append(extreme)
                rising, extreme = not rising, angle
        return ends[True], ends[False]


def wall_speed(run):
    """Tangential velocity of the liquid at the wall above the bed, over the wall's: a line through the cells next to it."""
    cell, ratios, depths = run.parameters["cell"], [], []
    for time, name in run.frames():
        if time <= BEGIN:
            continue
        frame = run.frame(name)
        y, x = np.indices(frame["pressure"].shape)
        arm = (np.stack([x, y]) + 0.5) * cell - CENTRE
        r = np.hypot(*arm)
        tangential = (arm[0] * frame["velocity"][..., 1] - arm[1] * frame["velocity"][..., 0]) / r
        near = (frame["solid_fraction"] == 0) & (r > RADIUS - 4 * cell) & (r < RADIUS - cell) & (arm[1] > 0.6 * RADIUS)
        ratios.append(tangential[near] / (SPIN * r[near]))
        depths.append(RADIUS - r[near])
    return np.polyfit(np.concatenate(depths), np.concatenate(ratios), 1)[1]


def told_of(bed, name):
    starts, rests = bed.avalanches()
    told = [quantity(f"slope {name}", bed.angles.mean(), "degrees"), quantity(f"its spread {name}", bed.angles.std(), "degrees"),
            quantity(f"avalanches {name}", len(rests), "1")]
    if starts and rests:
        told += [quantity(f"slope before an avalanche {name}", np.mean(starts), "degrees"),
                 quantity(f"slope after an avalanche {name}", np.mean(rests), "degrees")]
    return told


def main():
    run = Run(sys.argv[1])
    wet, air = Bed(run), studies(run).get("variant-dry")
    why = "angular momentum: what turns the bed holds its weight, over the moment of the weight"
    results = [
        result("speed of the liquid at the wall", wall_speed(run), "1", 1.0, "it sticks to the drum: over the wall's", 0.1),
        result("torque of the drum on grains and liquid", wet.balance, "1", 1.0, why, 0.03)]
    told = [quantity("torque on the grains", wet.on_grains, "N m/m"), quantity("torque on the liquid", wet.on_liquid, "N m/m"),
            *told_of(wet, "in the liquid")]
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.6, 3.4), width_ratios=(1.15, 1))
    image = draw_speed(left, run, run.frames()[-1][1], 0.06, length_unit=1e-3)
    left.set(xlabel="x [mm]", ylabel="y [mm]")
    figure.colorbar(image, ax=left, label="speed [m/s]")
    right.plot(wet.times, wet.history, label="in the liquid")
    if air:
        dry = Bed(air)
        results += [result("torque of the drum, dry", dry.balance, "1", 1.0, why, 0.03),
                    result("slope in the liquid", wet.angles.mean(), "degrees", dry.angles.mean(), "that of the dry bed, within the "
                           "swing of its avalanches", 0.25)]
        told += told_of(dry, "dry")
        right.plot(dry.times, dry.history, label="dry")
    right.axhspan(15, 21, color="0.85", zorder=0, label="discs of friction 0.5, rest … start")
    right.set(xlabel="time [s]", ylabel="slope of the bed [degrees]")
    right.legend(fontsize=7)
    run.write_results(results, told)
    figure.tight_layout()
    run.save(figure, "drum.png")


if __name__ == "__main__":
    main()
