"""Results and pictures of hindered_settling. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_slice, quantity, read_table, result, studies

RICHARDSON_ZAKI, GARSIDE = 4.65, 5.1  # exponents for slow flow: of 1954, and of later measurements in the same form
TRANSIENT = 1 / 3  # part of the run before the mean begins
ARRAY_TOLERANCE, TOLERANCE = 0.03, 0.10
HASIMOTO = 1.7601  # of a simple cubic array: what the images of a sphere take of its velocity, over φ^⅓


@dataclass
class Settled:
    """A run's mean velocity against the mixture, over that of a single sphere in boundless fluid."""

    count: int
    phi: float
    ratio: float
    scatter: float  # of the mean velocity in time
    carried: float  # part of the weight that nothing carries: the mixture falls faster and faster by it

    @property
    def boundless(self):
        """In a box without end: the box keeps down the long waves of the random places, which S(0) measures, and with
        them φ^⅓ N^-⅓ of the velocity [Ladd 1990, Mo and Sangani 1994]."""
        return self.ratio + HASIMOTO * structure(self.phi) * (self.phi / self.count) ** (1 / 3) / viscosity(self.phi)


def structure(phi):
    """S(0) of hard spheres at random places [Carnahan and Starling 1969]."""
    return (1 - phi) ** 4 / (1 + 4 * phi + 4 * phi**2 - 4 * phi**3 + phi**4)


def viscosity(phi):
    """Of the suspension over that of the fluid [Ladd 1990]."""
    s = phi * (1 + phi - 0.189 * phi**2)
    return (1 + 1.5 * s) / (1 - s)


def cubic_array(phi):
    """Velocity of a simple cubic array over that of a single sphere [Sangani and Acrivos 1982]."""
    return 1 - HASIMOTO * phi ** (1 / 3) + phi - 1.5593 * phi**2


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


def settled(run):
    p = run.parameters
    times, ratio, spheres, mixture = history(run)
    late = times > TRANSIENT * times[-1]
    count = len(np.unique(read_table(run.folder / "probes.csv")["id"]))
    phi = count * np.pi / 6 * p["diameter"]**3 / (p["box_x"] * p["box_y"] * p["box_z"])
    excess = p["particle_density"] - p["density"]
    momentum = excess * phi * spheres + p["density"] * mixture
    rate = np.polyfit(times[late], momentum[late], 1)[0]
    return Settled(count, phi, ratio[late].mean(), ratio[late].std(), rate / (excess * phi * p["gravity_z"]))


def judged(found):
    results = []
    for s in found:
        if s.count == 1:
            results.append(result("velocity of a simple cubic array", s.ratio, "V/V_Stokes", cubic_array(s.phi),
                                  "Sangani and Acrivos 1982", ARRAY_TOLERANCE))
            continue
        results.append(result(f"hindered velocity at φ = {s.phi:.3f}, without the box", s.boundless, "V/V_Stokes",
                              (1 - s.phi) ** GARSIDE, "Richardson and Zaki's (1-φ)^n, n = 5.1 of Garside and Al-Dibouni 1977",
                              TOLERANCE))
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
            rows += [quantity(f"exponent n at φ = {s.phi:.3f}", np.log(s.boundless) / np.log(1 - s.phi), "1"),
                     quantity(f"against Richardson and Zaki's n = 4.65 at φ = {s.phi:.3f}",
                              100 * (s.boundless / (1 - s.phi) ** RICHARDSON_ZAKI - 1), "%")]
    return rows


def picture_velocity(found, run):
    figure, ax = plt.subplots(figsize=(5.6, 3.8))
    phi = np.linspace(0, 0.35, 100)
    ax.plot(phi, (1 - phi) ** RICHARDSON_ZAKI, color="0.4", label="Richardson and Zaki, n = 4.65")
    ax.plot(phi, (1 - phi) ** GARSIDE, ":", color="0.4", label="Garside and Al-Dibouni, n = 5.1")
    ax.plot(phi, np.where(phi < 0.1, 1 - 6.55 * phi, np.nan), "--", color="0.6", label="Batchelor 1972, dilute")
    many = sorted((s for s in found if s.count > 1), key=lambda s: s.phi)
    ax.errorbar([s.phi for s in many], [s.ratio for s in many], [s.scatter for s in many], fmt="o", mfc="none",
                color="C0", label="in the periodic box")
    ax.plot([s.phi for s in many], [s.boundless for s in many], "o", color="C1", label="without the box")
    for s in found:
        if s.count == 1:
            ax.plot([s.phi], [s.ratio], "s", color="C2", label="one sphere in the box")
            ax.plot([s.phi], [cubic_array(s.phi)], "+", color="k", ms=12, label="Sangani and Acrivos, cubic array")
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
