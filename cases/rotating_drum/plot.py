"""Results and pictures of rotating_drum. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_speed, quantity, read_table, result, studies

CENTRE, RADIUS, SPIN = 0.0384, 0.030, 1.0  # m, m, rad/s
STEADY = 0.5                               # part of the run after which the bed has come to its slope
GRAVITY = 9.81


def torques(run):
    """Means of the steady part, per metre of depth [N m/m]: of the wall on the grains and on the fluid, and what the
    weight of the grains asks for; and a history (times, moment of the weight)."""
    p = run.parameters
    drum = np.loadtxt(run.folder / "drum.txt", ndmin=2)  # step, torque, x and y of the middle
    loads = read_table(run.folder / "obstacles.csv")
    grains = read_table(run.folder / "probes.csv")
    first = grains["time"] == grains["time"][0]
    area = np.count_nonzero(first) * np.pi * p["diameter"] ** 2 / 4
    weight = (p["particle_density"] - p["density"]) * area * GRAVITY
    end = grains["time"].max()
    times = drum[:, 0] / drum[-1, 0] * end
    late = times > STEADY * end
    fluid = -loads["torque"][loads["time"] > STEADY * end].mean() / p["depth"]
    return drum[late, 1].mean() / p["depth"], fluid, weight * (drum[late, 2].mean() - CENTRE), times, weight * (drum[:, 2] - CENTRE)


def slope(particles):
    """Angle of the bed's surface [degrees]: a line through the uppermost grains of columns two grains wide."""
    x, y, r = particles[:, 1] - CENTRE, particles[:, 2] - CENTRE, particles[0, 3]
    edges = np.arange(-0.7 * RADIUS, 0.7 * RADIUS, 4 * r)
    tops = [(0.5 * (a + b), y[(x >= a) & (x < b)].max()) for a, b in zip(edges[:-1], edges[1:]) if np.any((x >= a) & (x < b))]
    return np.degrees(np.arctan(np.polyfit(*np.array(tops).T, 1)[0]))


def angle(run):
    """Mean and spread of the slope in the steady part."""
    angles = [slope(run.frame(name)["particles"]) for time, name in run.frames() if time > STEADY * run.summary["physical_seconds"]]
    return np.mean(angles), np.std(angles)


def wall_speed(run):
    """Tangential velocity of the cells next to the wall above the bed over that of the wall there."""
    ratios = []
    for time, name in run.frames():
        if time <= STEADY * run.summary["physical_seconds"]:
            continue
        frame = run.frame(name)
        y, x = np.indices(frame["pressure"].shape)
        arm = (np.stack([x, y]) + 0.5) * run.parameters["cell"] - CENTRE
        r = np.hypot(*arm)
        tangential = (arm[0] * frame["velocity"][..., 1] - arm[1] * frame["velocity"][..., 0]) / r
        near = (frame["solid_fraction"] == 0) & (np.abs(r - RADIUS + 2 * run.parameters["cell"]) < run.parameters["cell"]) & (arm[1] > 0.6 * RADIUS)
        ratios.append(np.mean(tangential[near] / (SPIN * r[near])))
    return np.mean(ratios)


def main():
    run = Run(sys.argv[1])
    dry = studies(run).get("variant-dry")
    contact, fluid, moment, times, history = torques(run)
    wet_angle, spread = angle(run)
    results = [
        result("speed of the liquid at the wall", wall_speed(run), "1", 1.0, "it sticks to the drum: over the wall's", 0.1)]
    told = [quantity("torque of the drum over the moment of the weight", (contact + fluid) / moment, "1"),
            quantity("torque on the grains", contact, "N m/m"), quantity("torque on the liquid", fluid, "N m/m"),
            quantity("slope of the bed", wet_angle, "degrees"), quantity("its spread over the frames", spread, "degrees")]
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.6, 3.4), width_ratios=(1.15, 1))
    image = draw_speed(left, run, run.frames()[-1][1], 0.06, length_unit=1e-3)
    left.set(xlabel="x [mm]", ylabel="y [mm]")
    figure.colorbar(image, ax=left, label="speed [m/s]")
    right.plot(times, history, label="in the liquid")
    if dry:
        dry_contact, dry_fluid, dry_moment, times, history = torques(dry)
        dry_angle, _ = angle(dry)
        told += [quantity("torque of the dry drum over the moment of the weight", (dry_contact + dry_fluid) / dry_moment, "1"),
                 quantity("slope of the dry bed", dry_angle, "degrees")]
        right.plot(times, history, label="dry")
    right.set(xlabel="time [s]", ylabel="moment of the weight [N m/m]")
    right.legend()
    run.write_results(results, told)
    figure.tight_layout()
    run.save(figure, "drum.png")


if __name__ == "__main__":
    main()
