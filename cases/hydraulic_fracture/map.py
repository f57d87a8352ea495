"""The regime map of hydraulic_fracture: three packings of each strength and each leak-off. Usage: map.py OUT_FOLDER

Runs what is missing in OUT_FOLDER, 48 runs of ten seconds to half a minute, one after the other, and says how long each
took; writes map.csv and map.png there. May be stopped and called again. Needs built programs, and tools/ in PYTHONPATH.
"""

import json
import pathlib
import subprocess
import sys
import time

import matplotlib.pyplot as plt
import numpy as np
from bplbm import read_table, write_table

ROOT = pathlib.Path(__file__).resolve().parents[2]
STRENGTHS, RATIOS, SEEDS = ("400", "1000", "1500", "3000"), ("0.8", "0.9", "0.95", "1.0"), ("11", "12", "13")
TOUGHNESS = 18.0  # Pa√m per newton of a bond's strength: bonded_compression
PRESSURE, NOTCH = 6e5, 0.02  # Pa, m


def run_point(out, strength, ratio, seed):
    """Quantities of a run by name; runs it where that was not done."""
    folder = out / f"strength{strength}-ratio{ratio}-seed{seed}"
    if not (folder / "animation.gif").exists():
        begin = time.monotonic()
        subprocess.run(["/usr/bin/python3", ROOT / "tools/launch.py", "hydraulic_fracture", "--strength", strength, "--ratio",
                        ratio, "--seed", seed, "--out", folder, "--force"], check=True, stdout=subprocess.DEVNULL)
        print(f"map | strength {strength} N, ratio {ratio}, seed {seed}: {time.monotonic() - begin:.0f} s", flush=True)
    return {q["name"]: q["value"] for q in json.loads((folder / "summary.json").read_text())["quantities"]}


def regime(bonds_of_the_crack, length, height):
    """0 nothing: fewer than two bonds from the notch; 1 fracture: twice as long as high; 2 forks or a cloud."""
    return 0 if bonds_of_the_crack < 2 else 1 if length >= 2 * height else 2


def row(out, strength, ratio, seed):
    """The excess is that of a block that does not break, of the strongest bonds: a crack lets the pressure out of the notch."""
    q, intact = run_point(out, strength, ratio, seed), run_point(out, STRENGTHS[-1], ratio, seed)
    broken, length, height = (q[n] for n in ("bonds broken", "length of the crack, with the notch", "height of the crack"))
    drive = 1.12 * PRESSURE * np.sqrt(np.pi * NOTCH) / (TOUGHNESS * float(strength))
    excess = (intact["pressure in the notch"] - intact["pressure in the ground"]) / PRESSURE
    return {"strength": float(strength), "ratio": float(ratio), "seed": float(seed), "drive": drive, "excess": excess,
            "broken": broken, "of_the_crack": q["of them in the crack"], "length": length, "height": height,
            "regime": regime(q["of them in the crack"], length, height)}


def draw(table, path):
    figure, axes = plt.subplots(figsize=(5.6, 4.2))
    for number, (color, label) in enumerate((("0.7", "nothing"), ("tab:red", "fracture"), ("tab:purple", "forks, cloud"))):
        chosen = table["regime"] == number
        axes.scatter(table["drive"][chosen], np.maximum(table["excess"][chosen], 0.01), color=color, label=label, s=28)
    drive = np.array([2.5, 30.0])
    for product in (1.0, 2.0, 8.0):
        axes.plot(drive, product / drive, "k--", linewidth=0.8)
        axes.annotate(f"product {product:g}", (drive[1], product / drive[1]), fontsize=7, ha="right", va="bottom")
    paper = TOUGHNESS * 3000.0
    axes.axvline(1.12 * PRESSURE * np.sqrt(np.pi * NOTCH) / paper, color="tab:blue", linewidth=0.8)
    axes.annotate("the paper's 3000 N", (1.03 * 1.12 * PRESSURE * np.sqrt(np.pi * NOTCH) / paper, 0.02), color="tab:blue",
                  fontsize=7)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("drive: 1.12 p √(π a) over toughness")
    axes.set_ylabel("pressure in the notch above the ground's,\nover that at the inlet")
    axes.legend()
    figure.savefig(path, bbox_inches="tight")


def main():
    out = pathlib.Path(sys.argv[1]).resolve()
    out.mkdir(parents=True, exist_ok=True)
    rows = [row(out, strength, ratio, seed) for seed in SEEDS for ratio in RATIOS for strength in STRENGTHS]
    write_table(out / "map.csv", {key: np.array([r[key] for r in rows]) for key in rows[0]})
    draw(read_table(out / "map.csv"), out / "map.png")


if __name__ == "__main__":
    main()
