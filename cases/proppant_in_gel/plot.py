"""Results and pictures of proppant_in_gel. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_slice, draw_viscosity, fall_in_layers, quantity, read_table, result, studies

NEWTONIAN = "fluid-newtonian"
FLUIDS = {"": (1.0, 0.5), NEWTONIAN: (0.0966, 1.0)}  # consistency [Pa sⁿ], index
DEVELOPED = 0.25  # part of the run before the means begin
MIDDLE = 1 / 14  # of the width, to either side: half a diameter, where the slot shears a grain less than its fall does
PROFILE_TOLERANCE, CARRIED_TOLERANCE, SETTLING_TOLERANCE = 0.05, 0.05, 0.15
# Fall of a sphere over Novotny's estimate at V/(D γ̇), n = 0.5: tests/reference/sphere_in_shear.py, in a hollow one of 8 radii
OVER_NOVOTNY = (0.02, 0.05, 0.1, 0.2, 0.4, 0.8), (1.0776, 1.0782, 1.0805, 1.0886, 1.1126, 1.1550)


@dataclass
class Slot:
    """Gel alone between walls at ±w/2 with a mean velocity: u = U (2n+1)/(n+1) (1 - |2y/w|^(1+1/n))."""

    consistency: float
    index: float
    width: float
    mean: float

    def velocity(self, y):
        n = self.index
        return self.mean * (2 * n + 1) / (n + 1) * (1 - np.abs(2 * y / self.width) ** (1 + 1 / n))

    def shear_rate(self, y):
        n = self.index
        return self.mean * (2 * n + 1) / n * 2 / self.width * np.abs(2 * y / self.width) ** (1 / n)

    def pressure_gradient(self):
        n = self.index
        return 2 / self.width * self.consistency * (self.mean * (2 * n + 1) / n * 2 / self.width) ** n

    def over_grain(self, y, diameter, value):
        """Mean of value(y) over the volume of a grain."""
        t, w = np.polynomial.legendre.leggauss(12)
        weight = w * (1 - t**2) / np.sum(w * (1 - t**2))
        places = np.clip(np.asarray(y)[..., None] + 0.5 * diameter * t, -0.5 * self.width, 0.5 * self.width)
        return (value(places) * weight).sum(-1)

    def settling(self, y, diameter, stress):
        """Stokes' velocity with the viscosity at the shear rate of the slot and of the fall, V/D, together [Novotny1977].
        stress: Δρ g D [Pa]."""
        slot = self.over_grain(y, diameter, self.shear_rate)
        v = np.full_like(slot, 1e-6)
        for _ in range(200):
            viscosity = self.consistency * np.hypot(slot, v / diameter) ** (self.index - 1)
            v = 0.5 * (v + stress * diameter / (18 * viscosity))
        return v

    def fall(self, y, diameter, stress):
        """The same with what the estimate leaves out: how a sphere disturbs the shear that it falls across."""
        v = self.settling(y, diameter, stress)
        if self.index == 1:
            return v
        shear, (fast, factor) = v / (diameter * self.over_grain(y, diameter, self.shear_rate)), OVER_NOVOTNY
        return v * np.interp(shear, np.array(fast) / factor, factor)


def history(run):
    """Rows of the grains after the flow has developed, y from the middle, with their fall against the mixture at their own
    place between the walls: it sinks in the middle, too."""
    table, p = read_table(run.folder / "probes.csv"), run.parameters
    late = table["time"] > DEVELOPED * table["time"].max()
    rows = {name: column[late] for name, column in table.items()}
    rows["fall"] = fall_in_layers(run, rows)
    rows["y"] = rows["y"] - 0.5 * p["box_y"]
    return rows


@dataclass
class Transport:
    """What a run shows."""

    slot: Slot
    y: np.ndarray  # of the layers of cells
    profile: np.ndarray  # mean velocity of fluid and grains in them
    grains: dict
    carried: float  # mean velocity of the grains over that of the gel at their places
    carried_exact: float
    estimate: np.ndarray  # of each row's fall, of one grain [m/s]

    def settling(self, middle):
        """Mean fall of the grains in the middle or off it, and its estimate [m/s]."""
        chosen = (np.abs(self.grains["y"]) < MIDDLE * self.slot.width) == middle
        return self.grains["fall"][chosen].mean(), self.estimate[chosen].mean()


def transport(run, name):
    p = run.parameters
    frames = [frame for frame in run.fields if frame.time > DEVELOPED * run.summary["physical_seconds"]]
    profile = np.mean([np.asarray(frame.velocity)[..., 0].mean(axis=(0, 2)) for frame in frames], axis=0)
    y = (np.arange(len(profile)) + 0.5) * p["cell"] - 0.5 * p["box_y"]
    slot = Slot(*FLUIDS[name], p["box_y"], profile.mean())
    grains, d = history(run), p["diameter"]
    stress = (p["particle_density"] - p["density"]) * -p["gravity_z"] * d
    return Transport(slot, y, profile, grains, grains["vx"].mean(),
                     slot.over_grain(grains["y"], d, slot.velocity).mean(), slot.fall(grains["y"], d, stress))


def judged(found):
    results = []
    for name, t in found.items():
        what = "gel" if name == "" else "Newtonian"
        error = np.sqrt(np.mean((t.profile - t.slot.velocity(t.y)) ** 2)) / t.slot.mean
        results += [result(f"{what}: rms error of the profile", error, "1", 0.0,
                           "power law alone, over the mean velocity", PROFILE_TOLERANCE, scale=1.0),
                    result(f"{what}: speed of the grains", t.carried, "m/s", t.carried_exact,
                           "of the gel alone, over each grain's volume", CARRIED_TOLERANCE)]
    if NEWTONIAN in found:
        (gel, estimate), (other, plain) = found[""].settling(False), found[NEWTONIAN].settling(False)
        results.append(result("settling in gel over that in the Newtonian fluid, off the middle", gel / other, "1",
                              estimate / plain, "Novotny1977, times what a solution about a sphere has over it",
                              SETTLING_TOLERANCE))
    return results


def quantities(found, run):
    rows = []
    for name, t in found.items():
        what = "gel" if name == "" else "Newtonian"
        rows += [quantity(f"{what}: mean velocity of the flow", t.slot.mean, "m/s"),
                 quantity(f"{what}: pressure gradient of the fluid alone at that flow", t.slot.pressure_gradient(), "Pa/m"),
                 quantity(f"{what}: speed of the grains over the mean", t.carried / t.slot.mean, "1"),
                 *(quantity(f"{what}: settling {where}{how}", value, "m/s")
                   for middle, where in ((True, "in the middle"), (False, "off the middle"))
                   for value, how in zip(t.settling(middle), ("", ", estimated, one grain"), strict=True))]
    return rows + [quantity("grains", len(np.unique(found[""].grains["id"])), "1")]


def picture(found, run):
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.4))
    diameter = run.parameters["diameter"]
    for color, (name, t) in zip(("C0", "C1"), found.items(), strict=False):
        what = "gel, n = 0.5" if name == "" else "Newtonian"
        left.plot(t.y * 1e3, t.slot.velocity(t.y), color=color, label=f"{what}, exact")
        left.plot(t.y * 1e3, t.profile, ".", ms=3, color=color, label=f"{what}, with grains")
        places = np.array([[t.grains[c][t.grains["id"] == i].mean() for c in ("y", "fall")] for i in np.unique(t.grains["id"])])
        right.plot(places[:, 0] * 1e3, places[:, 1] * 1e3, "o", ms=4, mfc="none", color=color, label=what)
        p, line = run.parameters, np.linspace(-0.5, 0.5, 81) * (run.parameters["box_y"] - diameter)
        stress = (p["particle_density"] - p["density"]) * -p["gravity_z"] * diameter
        right.plot(line * 1e3, t.slot.fall(line, diameter, stress) * 1e3, color=color, lw=0.9)
    for ax, name in ((left, "velocity along the slot [m/s]"), (right, "settling [mm/s]")):
        ax.set_xlabel("y from the middle [mm]")
        ax.set_ylabel(name)
        ax.set_ylim(bottom=0)
    left.legend(fontsize=8)
    right.set_ylim(top=1.4 * right.get_ylim()[1])  # room for the legend
    right.legend(fontsize=8, loc="upper center", title="lines: one grain,\nwithout walls", title_fontsize=7)
    figure.tight_layout()
    run.save(figure, "transport.png")


def picture_plane(run):
    """Speed and viscosity on the plane half-way up, at the end."""
    figure, axes = plt.subplots(1, 2, figsize=(7.6, 3.6), sharey=True, layout="constrained")
    last = run.frames()[-1][1]
    image = draw_slice(axes[0], run, last, "z", length_unit=1e-3)
    figure.colorbar(image, ax=axes[0], label="speed [m/s]", fraction=0.05, pad=0.03)
    if "viscosity" in run.frame(last):
        image = draw_viscosity(axes[1], run, last, "z", length_unit=1e-3)
        figure.colorbar(image, ax=axes[1], label="viscosity [Pa s]", fraction=0.05, pad=0.03)
    axes[1].set_ylabel("")
    run.save(figure, "field.png")


def main():
    run = Run(sys.argv[1])
    own = "" if run.summary.get("variant", "") in ("", "resolved") else run.summary["variant"]
    found = {own: transport(run, own), **{name: transport(r, name) for name, r in studies(run).items() if name in FLUIDS}}
    run.write_results(judged(found), quantities({"": found.get("", found[own]), **found}, run))
    picture(found, run)
    picture_plane(run)


if __name__ == "__main__":
    main()
