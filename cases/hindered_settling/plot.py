"""Results and pictures of hindered_settling. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import itertools
import sys
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_slice, quantity, read_table, result, studies

LAWS = {"Richardson and Zaki 1954": 4.65, "Garside and Al-Dibouni 1977": 5.1}  # exponents for slow flow
BRANCHES = 4.48, 5.6  # of many measurements, without and with Brownian motion [BrzinskiDurian2018]
TRANSIENT = 1 / 3  # part of the run before the mean begins
ARRAY_TOLERANCE = 0.01  # 0.5 % seen at 8 cells a diameter
TOLERANCE = 0.05  # thrice 0.7 %, the scatter by the choice of places, and a tenth of what the box takes, 29 % at most
SHORTEST = 5  # waves down to this part of the box enter the sum over the places
HASIMOTO = 1.7601  # of a simple cubic array: what the images of a sphere take of its velocity, over φ^⅓


@dataclass
class Settled:
    """A run's mean velocity against the mixture, over that of a single sphere in boundless fluid."""

    count: int
    phi: float
    ratio: float
    scatter: float  # of the mean velocity in time
    waves: float  # of the mean velocity: what the places add by chance and by how they were chosen
    carried: float  # part of the weight that nothing carries: the mixture falls faster and faster by it

    @property
    def boundless(self):
        """Of hard spheres in a box without end: the box keeps down the long waves of the random places, which S(0)
        measures, and with them φ^⅓ N^-⅓ of the velocity [Ladd1990, MoSangani1994]."""
        held = HASIMOTO * structure(self.phi) * (self.phi / self.count) ** (1 / 3) / viscosity(self.phi)
        return self.ratio - self.waves + held


def structure(phi):
    """S(0) of hard spheres at random places [CarnahanStarling1969]."""
    return (1 - phi) ** 4 / (1 + 4 * phi + 4 * phi**2 - 4 * phi**3 + phi**4)


def viscosity(phi):
    """Of the suspension over that of the fluid [Ladd1990]."""
    s = phi * (1 + phi - 0.189 * phi**2)
    return (1 + 1.5 * s) / (1 - s)


def cubic_array(phi):
    """Velocity of a simple cubic array over that of a single sphere [SanganiAcrivosSpheres1982]."""
    return 1 - HASIMOTO * phi ** (1 / 3) + phi - 1.5593 * phi**2


def hard_spheres(phi):
    """Velocity of hard spheres at random places over that of a single one [Riest2015]."""
    return 1 - 6.5464 * phi * (1 - 3.348 * phi + 7.426 * phi**2 - 10.034 * phi**3 + 5.882 * phi**4)


def structure_factor(phi, q):
    """S(q) of hard spheres at random places, q in 1/D [Wertheim1963]."""
    r = (np.arange(400) + 0.5) / 400
    a, b = (1 + 2 * phi) ** 2 / (1 - phi) ** 4, -6 * phi * (1 + phi / 2) ** 2 / (1 - phi) ** 4
    return 1 / (1 + 24 * phi * np.mean((a + b * r + phi * a / 2 * r**3) * r * np.sin(q * r) / q))


def waves(places, side, phi):
    """What the waves of the places, (times, spheres, 3) in D, add to the mean velocity over Stokes', more than those of
    hard spheres at random places would: as weights spread over spheres move a fluid of the suspension's viscosity. The
    box is cubic, side in D."""
    total = 0.0
    for n in itertools.product(range(-SHORTEST, SHORTEST + 1), repeat=3):
        square = sum(i * i for i in n)
        if not 0 < square <= SHORTEST**2:
            continue
        seen = np.mean(abs(np.exp(2j * np.pi / side * (places @ n)).sum(axis=1)) ** 2) / places.shape[1]
        across, size = 1 - n[2] ** 2 / square, np.sinc(np.sqrt(square) / side) ** 2
        excess = seen - structure_factor(phi, 2 * np.pi * np.sqrt(square) / side)
        total += 3 / (4 * np.pi * side * square) * across * size * excess
    return total / viscosity(phi)


def stokes(p):
    """Velocity of a single sphere [m/s]."""
    return (p["particle_density"] / p["density"] - 1) * -p["gravity_z"] * p["diameter"]**2 / (18 * p["kinematic_viscosity"])


def history(run):
    """Time, and mean velocity of the spheres downward against the mixture, over Stokes' velocity."""
    table, p = read_table(run.folder / "probes.csv"), run.parameters
    times = np.unique(table["time"])
    spheres = np.array([table["vz"][table["time"] == t].mean() for t in times])
    frames = [(frame.time, float(frame.velocity[..., 2].mean())) for frame in run.fields]  # covered cells have the spheres'
    return times, (np.interp(times, *np.transpose(frames)) - spheres) / stokes(p), spheres, np.interp(times, *np.transpose(frames))


def added_by_waves(run, count, phi):
    """Of the late part of a run; nothing for a single sphere."""
    if count == 1:
        return 0.0
    table, p = read_table(run.folder / "probes.csv"), run.parameters
    late = table.where(table["time"] > TRANSIENT * table["time"].max())
    places = np.stack([late[axis] for axis in "xyz"], axis=1).reshape(-1, count, 3) / p["diameter"]
    return waves(places[::10], p["box_x"] / p["diameter"], phi)


def settled(run):
    p = run.parameters
    times, ratio, spheres, mixture = history(run)
    late = times > TRANSIENT * times[-1]
    count = len(np.unique(read_table(run.folder / "probes.csv")["id"]))
    phi = count * np.pi / 6 * p["diameter"]**3 / (p["box_x"] * p["box_y"] * p["box_z"])
    excess = p["particle_density"] - p["density"]
    momentum = excess * phi * spheres + p["density"] * mixture
    rate = np.polyfit(times[late], momentum[late], 1)[0]
    return Settled(count, phi, ratio[late].mean(), ratio[late].std(), added_by_waves(run, count, phi),
                   rate / (excess * phi * p["gravity_z"]))


def judged(found):
    results = []
    for s in found:
        if s.count == 1:
            results.append(result("velocity of a simple cubic array", s.ratio, "V/V_Stokes", cubic_array(s.phi),
                                  "Sangani and Acrivos 1982", ARRAY_TOLERANCE))
            continue
        results.append(result(f"hindered velocity at φ = {s.phi:.3f}, without the box", s.boundless, "V/V_Stokes",
                              hard_spheres(s.phi), "hard spheres at random places, Riest et al. 2015", TOLERANCE))
    results.append(result("part of the weight that is not carried", found[0].carried, "1", 0.0,
                          "the fluid carries it: the mixture does not fall", 0.001, scale=1.0))
    return results


def quantities(found, p):
    rows = [quantity("Stokes' velocity of a single sphere", stokes(p), "m/s")]
    for s in found:
        rows += [quantity(f"V/V_Stokes in the box at φ = {s.phi:.3f}", s.ratio, "1"),
                 quantity(f"its scatter in time at φ = {s.phi:.3f}", s.scatter, "1"),
                 quantity(f"spheres at φ = {s.phi:.3f}", s.count, "1")]
        if s.count > 1:
            rows += [quantity(f"of this the waves of the places at φ = {s.phi:.3f}", s.waves, "1"),
                     quantity(f"exponent n at φ = {s.phi:.3f}", np.log(s.boundless) / np.log(1 - s.phi), "1")]
    return rows


def picture_velocity(found, run):
    figure, ax = plt.subplots(figsize=(5.6, 3.8))
    phi = np.linspace(0, 0.35, 100)
    ax.fill_between(phi, *((1 - phi) ** n for n in BRANCHES), color="0.9", label="measured, n = 4.48 … 5.6")
    for (label, n), style in zip(LAWS.items(), ("-", ":")):
        ax.plot(phi, (1 - phi) ** n, style, color="0.6", label=f"{label}, n = {n}")
    ax.plot(phi, hard_spheres(phi), color="k", label="hard spheres at random places")
    many = sorted((s for s in found if s.count > 1), key=lambda s: s.phi)
    ax.errorbar([s.phi for s in many], [s.ratio for s in many], [s.scatter for s in many], fmt="o", mfc="none",
                color="C0", label="in the periodic box")
    ax.plot([s.phi for s in many], [s.boundless for s in many], "o", color="C1", label="without the box, places at random")
    for s in found:
        if s.count == 1:
            ax.plot([s.phi], [s.ratio], "s", color="C2", label="one sphere in the box")
            ax.plot([s.phi], [cubic_array(s.phi)], "+", color="k", ms=12, label="cubic array")
    ax.set_xlabel("volume fraction φ")
    ax.set_ylabel("velocity over that of a single sphere")
    ax.set_ylim(0, 1.05)
    ax.legend(fontsize=8)
    run.save(figure, "velocity.png")


def picture_history(runs, run):
    figure, ax = plt.subplots(figsize=(5.6, 3.2))
    for r in runs:
        s = settled(r)
        times, ratio, *_ = history(r)
        ax.plot(times, ratio, label=f"φ = {s.phi:.3f}, {s.count} sphere{'s' if s.count > 1 else ''}")
    ax.set_xlabel("time [s]")
    ax.set_ylabel("V/V_Stokes in the box")
    ax.legend(fontsize=8)
    run.save(figure, "history.png")


def main():
    run = Run(sys.argv[1])
    runs = [run, *studies(run).values()]
    found = [settled(r) for r in runs]
    run.write_results(judged(found), quantities(found, run.parameters))
    picture_velocity(found, run)
    picture_history(runs, run)
    figure, ax = plt.subplots(figsize=(4.4, 4.0))
    draw_slice(ax, run, run.frames()[-1][1], "y", vmax=1.5 * stokes(run.parameters))
    run.save(figure, "field.png")


if __name__ == "__main__":
    main()
