"""Results and pictures of mud_settling. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_viscosity, fall_in_layers, quantity, read_table, result, studies

REST, SHEARED, STOPPED = (0.15, 0.3), (0.5, 1.3), (1.5, 1.8)  # s: after the transients, see plates.csv
SHEAR_RATE, YIELD_STRESS, PLASTIC = 15.0, 13.7, 0.15  # 1/s, Pa, Pa s
OIL = "fluid-oil"
SHOWN = {"at rest": 0.2, "sheared": 1.2}  # s, in the picture of the viscosity
CREEP_TOLERANCE, STOPPED_TOLERANCE, SHEARED_TOLERANCE = 0.05, 0.15, 0.06
SOLUTION = 1.1174, 1.1231, 1.1482, 1.2197  # see fall_in_shear
ALONE, ALONE_TOLERANCE = 0.6, 0.25  # without a run to compare with


@dataclass
class Fall:
    """Mean velocity of the cuttings downward against the mixture [m/s], over time."""

    times: np.ndarray
    velocity: np.ndarray
    frames: np.ndarray  # times at which the mixture's own velocity is known; it is straight between them
    around: np.ndarray  # against the mixture in each one's own layer between the plates

    def mean(self, span):
        """Over a span; of what creeps only at the frames, since the mixture's velocity changes by more between them."""
        times = self.times if span == SHEARED else self.frames
        inside = times[(times > span[0]) & (times < span[1] + 1e-3)]
        return np.interp(inside, self.times, self.velocity).mean() if inside.any() else np.nan

    def sheared(self):
        """Against the mixture around, while the plates move."""
        return self.around[(self.times > SHEARED[0]) & (self.times < SHEARED[1] + 1e-3)].mean()


def fall(run):
    table = read_table(run.folder / "probes.csv")
    times = np.unique(table["time"])
    cuttings = np.array([table["vz"][table["time"] == t].mean() for t in times])
    frames = [(frame.time, float(frame.velocity[..., 2].mean())) for frame in run.fields]  # covered cells have the cuttings'
    known, mixture = np.transpose(frames)
    against = fall_in_layers(run, table)
    around = np.array([against[table["time"] == t].mean() for t in times])
    return Fall(times, np.interp(times, known, mixture) - cuttings, known, around)


def apparent():
    """Viscosity of the sheared mud [Pa s]."""
    return PLASTIC + YIELD_STRESS / SHEAR_RATE


def fall_in_shear(velocity, p):
    """Velocity of a sphere across the shear of this mud over that in oil of its apparent viscosity, by tests/reference/
    sphere_in_shear.py in a hollow sphere of 8 radii, whose Newtonian drag is about that of these cuttings."""
    shear = velocity / (p["diameter"] * SHEAR_RATE)  # of the fall, over that of the plates
    return np.interp(shear, (0.03, 0.06, 0.13, 0.26), SOLUTION)


def stokes(p, viscosity):
    """Velocity of a single sphere in boundless fluid [m/s]."""
    return (p["particle_density"] - p["density"]) * -p["gravity_z"] * p["diameter"]**2 / (18 * viscosity)


def judged(run, mud, oil, thick):
    """thick: viscosity below the yield stress [Pa s]."""
    if run.summary["variant"]:
        return []
    results = []
    if oil is None:
        return [result("creep of the mud at rest, over Stokes' velocity of one grain at nu_max",
                       mud.mean(REST) / stokes(run.parameters, thick), "1", ALONE,
                       "what other grains (0.88), the box's images (-0.18) and the plates leave", ALONE_TOLERANCE)]
    for name, span in (("at rest", REST), ("when it has stopped", STOPPED)):
        if np.isnan(mud.mean(span)):
            continue
        results.append(result(f"creep of the mud {name}, over that of a Newtonian fluid as thick", mud.mean(span) / oil.mean(REST),
                              "1", apparent() / thick, "the same places; nothing yields below the yield number 0.0477, here 0.25",
                              CREEP_TOLERANCE if span == REST else STOPPED_TOLERANCE))
    if not np.isnan(mud.mean(SHEARED)):
        results.append(result("settling in sheared mud against the mixture around, over that in oil of its apparent viscosity",
                              mud.sheared() / oil.sheared(), "1", fall_in_shear(mud.sheared(), run.parameters),
                              "sphere in a hollow one, tests/reference/sphere_in_shear.py", SHEARED_TOLERANCE))
    return results


def quantities(run, mud, others):
    p = run.parameters
    weight = (p["particle_density"] - p["density"]) * -p["gravity_z"] * p["diameter"]
    rows = [quantity("yield number σ_y/(Δρ g D)", YIELD_STRESS / weight, "1"),
            quantity("Stokes' velocity at the apparent viscosity", stokes(p, apparent()), "m/s")]
    for name, f in {"mud": mud, **others}.items():
        for what, span in (("at rest", REST), ("sheared", SHEARED), ("stopped", STOPPED)):
            if not np.isnan(f.mean(span)):
                rows.append(quantity(f"velocity against the mixture, {name}, {what}", f.mean(span), "m/s"))
    return rows


def picture_history(run, mud, others):
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(5.8, 5.0), sharex=True)
    names = {OIL: "oil of the apparent viscosity", "fluid-thin": "mud that cannot hold them (Y = 0.02)"}
    for name, f in {"mud (Y = 0.25)": mud, **{names.get(n, n): f for n, f in others.items()}}.items():
        fallen = np.concatenate([[0], np.cumsum(0.5 * (f.velocity[1:] + f.velocity[:-1]) * np.diff(f.times))])
        upper.plot(f.times, fallen / run.parameters["diameter"], label=name)
        lower.semilogy(f.times, np.maximum(f.velocity, 1e-6))
    upper.set_ylim(-0.2, 1.4 * max(0.5, np.max(upper.lines[0].get_ydata())))
    upper.set_ylabel("fallen [diameters]")
    upper.legend(fontsize=8)
    lower.set_ylabel("velocity [m/s]")
    lower.set_xlabel("time [s]")
    for ax in (upper, lower):
        ax.axvspan(0.3, 1.4, color="0.93", zorder=0)
    upper.text(0.85, 0.02, "sheared", transform=upper.get_xaxis_transform(), ha="center", fontsize=8, color="0.4")
    run.save(figure, "history.png")


def picture_viscosity(run):
    """A plane across the box while the mud holds the cuttings, and while it is sheared."""
    if "viscosity" not in run.frame(run.frames()[-1][1]):
        return
    near = {title: min(run.frames(), key=lambda f, time=time: abs(f[0] - time)) for title, time in SHOWN.items()}
    near = {title: frame for title, frame in near.items() if abs(frame[0] - SHOWN[title]) < 0.1}
    if not near:  # a run that was cut short
        return
    figure, axes = plt.subplots(1, len(near), figsize=(3.8 * len(near), 3.6), sharey=True, squeeze=False)
    thinnest, thickest = 0.5 * apparent(), run.parameters["density"] * 0.0443
    for ax, (title, (time, name)) in zip(axes[0], near.items()):
        image = draw_viscosity(ax, run, name, "x", (thinnest, thickest))
        ax.set_title(f"{title}, {time:.1f} s", fontsize=9)
    for ax in axes[0][1:]:
        ax.set_ylabel("")
    figure.colorbar(image, ax=axes, label="viscosity of the mud [Pa s]", fraction=0.03, pad=0.02)
    run.save(figure, "field.png")


def main():
    run = Run(sys.argv[1])
    mud, others = fall(run), {name: fall(r) for name, r in studies(run).items()}
    thick = run.parameters["density"] * 0.0443
    run.write_results(judged(run, mud, others.get(OIL), thick), quantities(run, mud, others))
    picture_history(run, mud, others)
    picture_viscosity(run)


if __name__ == "__main__":
    main()
