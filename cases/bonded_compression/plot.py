"""Results and pictures of bonded_compression. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import pathlib
import re
import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PatchCollection
from bplbm import Run, draw_breaks, quantity, read_breaks, read_table, result, studies

DRY = pathlib.Path(__file__).parents[1] / "pressurised_notch" / "dry.csv"
KINDS = ("compression", "tension", "brazilian", "notched20", "notched30", "notched40", "traction20", "traction30",
         "traction40", "slot_notched", "slot_traction")


class Test:
    """One sample between its grips. Stresses are positive in tension, per metre of depth."""

    def __init__(self, run):
        self.run, self.p = run, run.parameters
        variant = run.summary["variant"]
        self.kind = next((kind for kind in KINDS[1:] if kind in variant), "compression")
        self.law = "parallel" if "parallel" in variant else "contact"
        seed = re.search(r"seed-(\d+)", variant)
        self.seed = seed.group(1) if seed else "11"
        self.table = read_table(run.folder / "grips.csv")
        sign = np.sign(-self.p["speed"])
        self.force = self.table["force"]  # N: of the sample on the lower grip, upwards; pulled: positive
        self.peak = int(np.argmax(sign * self.force))
        self.strength = abs(self.force[self.peak]) / self.p["width"]
        if "traction" in self.kind:
            self.peak = int(np.argmax(self.table["tension"] + self.table["shear"] > 0))
            self.strength = self.notch_pressure() + self.force[self.peak] / self.p["width"]

    def strain(self, column):
        return self.table[column] / self.table[column][0] - 1.0

    def elastic(self):
        """Young's modulus [Pa] and Poisson's ratio: slopes between a tenth and four tenths of the strength."""
        part = np.abs(self.force[:self.peak + 1]) / abs(self.force[self.peak])
        rows = slice(int(np.argmax(part > 0.1)), int(np.argmax(part > 0.4)) + 1)
        axial, lateral = self.strain("tall")[rows], self.strain("wide")[rows]
        stress = self.force[rows] / self.p["width"]
        return np.polyfit(axial, stress, 1)[0], -np.polyfit(axial, lateral, 1)[0]

    def splitting_strength(self):
        """Of a disc pressed across [Pa]."""
        return 2 * abs(self.force[self.peak]) / (np.pi * self.p["width"])

    def notch_pressure(self):
        """On the faces of the notch, when the first bond breaks [Pa]; the grips at rest take up a part of what it does."""
        return self.p["notch_rate"] * self.table["time"][self.peak]

    def toughness(self):
        """Stress intensity [Pa √m] at the largest load of a plate with a notch of 2a in its middle, σ √(π a sec(π a/W))."""
        return self.strength * np.sqrt(np.pi * self.half_length()) * self.width_factor()

    def half_length(self):
        return self.p["notch"] * (1.0 if self.p["half"] else 0.5)

    def width_factor(self):
        return 1 / np.sqrt(np.cos(np.pi * self.half_length() / self.p["width"] / (2.0 if self.p["half"] else 1.0)))

    def toughness_of_bonds(self):
        """As toughness, but from the mean stress over the first bond ahead, of a diameter d; a pressure on the faces
        alone lacks the stress that a pull leaves there without any notch."""
        over = 0.25 * (self.p["diameter_min"] + self.p["diameter_max"]) / self.half_length()  # d/2a
        factor = self.width_factor() * np.sqrt(1 + over) - ("traction" in self.kind) * np.sqrt(over)
        return self.strength * np.sqrt(np.pi * self.half_length()) * factor

    def label(self):
        return f"seed {self.seed}" + (", parallel" if self.law == "parallel" else "")


def uniform_strain(test):
    """Young's modulus and strength of the same bonds if all discs moved by the mean strain [Pa]: ½ n l² k and ½ n l F,
    n bonds an area, l their length, normal and shear stiffness k alike."""
    p = test.p
    area = p["width"] * p["height"]
    n, length = test.table["bonds"][0] / area, 0.5 * (p["diameter_min"] + p["diameter_max"])
    return 0.5 * n * length**2 * p["bond_stiffness"], 0.5 * n * length * p["bond_strength"]


def pressed_and_pulled(tests):
    """Results of notches that a pressure on their faces opens, beside those of the same samples that are pulled."""
    found, told = [], []
    for pressed_kind, pulled_kind in (("traction20", "notched20"), ("traction30", "notched30"), ("traction40", "notched40"),
                                      ("slot_traction", "slot_notched")):
        pressed, pulled = ([t for t in tests if t.kind == kind] for kind in (pressed_kind, pulled_kind))
        if not pressed or not pulled:
            continue
        name = f"of {pressed_kind} over {pulled_kind}"
        found.append(result(f"toughness {name}, first bond", mean(t.toughness_of_bonds() for t in pressed)
                            / mean(t.toughness_of_bonds() for t in pulled), "1", 1.0,
                            "superposition: a pressure on the faces does what a pull does, less the pull", 0.15))
        if pressed_kind == "slot_traction":
            kept = read_table(DRY)
            found.append(result(f"pressure that starts {pressed_kind}, over that in pressurised_notch/dry.csv",
                                mean(t.notch_pressure() for t in pressed)
                                / mean(kept["pressure"][kept["seed"] == float(t.seed)][0] for t in pressed), "1", 1.0,
                                "what that scene compares with water", 0.01))
        told.append(quantity(f"toughness {name}, of a crack without grains", mean(t.toughness() for t in pressed)
                             / mean(t.toughness() for t in pulled), "1"))
    return found, told


def mean(values):
    return float(np.mean(list(values)))


def chosen(tests, kind, law="contact"):
    """Of the default strength, one a seed."""
    return [t for t in tests if t.kind == kind and t.law == law and t.p["bond_strength"] == tests[0].p["bond_strength"]]


def judge(tests):
    """Results and quantities of all tests beside each other, or of the one that there is."""
    first = tests[0]
    found, told = [], []
    if pressed := chosen(tests, "compression"):
        bound, _ = uniform_strain(pressed[0])
        found.append(result("Young's modulus", mean(t.elastic()[0] for t in pressed), "Pa", bound,
                            "uniform strain, ½ n l² k: an upper bound without new contacts", 0.3))
        told += [quantity("Poisson's ratio", mean(t.elastic()[1] for t in pressed), "1"),
                 quantity("compressive strength", mean(t.strength for t in pressed), "Pa")]
    if pulled := chosen(tests, "tension"):
        _, bound = uniform_strain(pulled[0])
        strength = mean(t.strength for t in pulled)
        told += [quantity("tensile strength", strength, "Pa"),
                 quantity("tensile strength over that of uniform strain", strength / bound, "1")]
    if split := chosen(tests, "brazilian"):
        told.append(quantity("splitting strength, 2P/πD", mean(t.splitting_strength() for t in split), "Pa"))
        if pulled:
            found.append(result("splitting strength over tensile strength", mean(t.splitting_strength() for t in split)
                                / mean(t.strength for t in pulled), "1", 1.0,
                                "a disc pressed across breaks by tension in its middle", 0.25))
    notched = {kind: chosen(tests, kind) for kind in KINDS if kind.startswith("notched")}
    means = {kind: mean(t.toughness() for t in group) for kind, group in notched.items() if group}
    for kind, value in means.items():
        told.append(quantity(f"toughness, notch of {kind[-2:]} mm", value, "Pa√m"))
    if "notched20" in means and len(means) == 3:
        for kind in ("notched30", "notched40"):
            found.append(result(f"toughness with {kind[-2:]} mm over that with 20 mm", means[kind] / means["notched20"],
                                "1", 1.0, "linear elastic fracture: a property of the material", 0.15))
        if pulled:
            k, radius = mean(means.values()), 0.25 * (first.p["diameter_min"] + first.p["diameter_max"])
            told.append(quantity("α of K = strength √(π α R)", (k / strength) ** 2 / (np.pi * radius), "1"))
    weaker = [t for t in tests if t.kind == "tension" and t.p["bond_strength"] < first.p["bond_strength"]]
    if weaker and pulled:
        ratio = weaker[0].p["bond_strength"] / first.p["bond_strength"]
        same = next(t for t in pulled if t.seed == weaker[0].seed)
        found.append(result("tensile strength over that of the bonds, weaker over default",
                            weaker[0].strength / same.strength / ratio, "1", 1.0,
                            "proportional, as long as strains are small", 0.15))
    worst = max(np.abs(t.table["unbalanced"][:t.peak]).mean() / np.abs(t.force[t.peak]) for t in tests)
    found.append(result("difference of the grips' forces before failure, over the largest", worst, "1", 0.0,
                        "equilibrium: slow enough", 0.05, scale=1.0))
    more = pressed_and_pulled(tests)
    found, told = found + more[0], told + more[1]
    for kind in ("compression", "tension"):
        if group := chosen(tests, kind, "parallel"):
            told.append(quantity(f"{kind}, parallel bonds", mean(t.strength for t in group), "Pa"))
    return found, told


def draw_curves(tests, run):
    figure, axes = plt.subplots(1, 4, figsize=(13.0, 3.0))
    groups = (("compression", "compression"), ("tension", "tension"), ("brazilian", "disc pressed across"),
              ("notched", "notched"))
    for ax, (kind, title) in zip(axes, groups):
        for t in tests:
            if not t.kind.startswith(kind) or t.p["slot"]:
                continue
            style = {"contact": "-", "parallel": "--"}[t.law]
            name = t.label() + (f", {t.kind[-2:]} mm" if kind == "notched" else "")
            scale = 1e3 * t.p["bond_strength"] / 3000.0
            name += "" if t.p["bond_strength"] == 3000.0 else f", {t.p['bond_strength']:g} N (scaled to 3000)"
            shown = 100 * np.abs(t.strain("ends")) * (3000.0 / t.p["bond_strength"])
            ax.plot(shown, np.abs(t.force) / t.p["width"] / scale, style, label=name)
        ax.set_title(title)
        ax.set_xlabel("strain between the grips [%]")
        if ax.lines:
            ax.legend(fontsize=6)
    axes[0].set_ylabel("force over width [kPa]")
    figure.tight_layout()
    run.save(figure, "curves.png")


def read_discs(path):
    """Discs of a dump's last frame: rows id, x, y, radius [m]."""
    lines = path.read_text().splitlines()
    start = max(i for i, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    return np.array([[float(word) for word in line.split()] for line in lines[start + 1:]])


def draw_samples(tests, run):
    shown = [next((t for t in tests if t.kind == kind and t.law == law), None)
             for kind, law in (("compression", "contact"), ("compression", "parallel"), ("tension", "contact"),
                               ("brazilian", "contact"), ("notched40", "contact"))]
    shown = [t for t in shown if t] or tests[:1]
    figure, axes = plt.subplots(1, len(shown), figsize=(2.9 * len(shown), 3.2), squeeze=False)
    for ax, t in zip(axes[0], shown):
        discs = read_discs(t.run.folder / "discs.txt")
        ax.add_collection(PatchCollection([plt.Circle((1e3 * x, 1e3 * y), 1e3 * r) for _, x, y, r in discs],
                                          facecolor="wheat", edgecolor="0.5", linewidth=0.4))
        draw_breaks(ax, read_breaks(t.run.folder / "breaks.csv"), length_unit=1e-3)
        ax.set_title(f"{t.kind}{', parallel' if t.law == 'parallel' else ''}", fontsize=9)
        ax.set_aspect("equal")
        ax.set_xlim(10, 130)
        ax.set_ylim(10, 130)
        ax.grid(False)
        ax.set_xlabel("x [mm]")
    axes[0][0].set_ylabel("y [mm]")
    figure.tight_layout()
    run.save(figure, "cracks.png")


def main():
    run = Run(sys.argv[1])
    tests = [Test(run)] + [Test(other) for other in studies(run).values()]
    run.write_results(*judge(tests))
    for t in tests:
        if "traction" in t.kind:
            print(f"run | note | {t.kind}, {t.label()}, {t.p['bond_strength']:g} N: the first bond breaks at a pressure of "
                  f"{t.notch_pressure() / 1e3:.1f} kPa, {t.strength / 1e3:.1f} kPa without what the grips take up")
            continue
        modulus, poisson = t.elastic()
        print(f"run | note | {t.kind}, {t.label()}, {t.p['bond_strength']:g} N: strength {t.strength / 1e3:.0f} kPa "
              f"at a strain of {100 * abs(t.strain('ends')[t.peak]):.2f} %, E = {modulus / 1e6:.1f} MPa, ν = {poisson:.2f}; broken "
              f"{t.table['tension'][-1]:.0f} by tension, {t.table['shear'][-1]:.0f} by shear, "
              f"{t.table['tension'][t.peak] + t.table['shear'][t.peak]:.0f} at the largest load")
    draw_curves(tests, run)
    draw_samples(tests, run)


if __name__ == "__main__":
    main()
