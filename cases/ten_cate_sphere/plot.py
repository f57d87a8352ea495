"""Results and pictures of ten_cate_sphere. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_slice, result, studies

# Largest velocity [m/s] by density of the fluid: E1, E2 and E4 of ten Cate, Nieuwstad, Derksen and Van den
# Akker, Phys. Fluids 14 (2002) 4012, measured to 1 %.
MEASURED = {970.0: ("E1", 0.0363), 965.0: ("E2", 0.0571), 960.0: ("E4", 0.1226)}


def judged(runs):
    results = []
    for run in runs:
        name, reference = MEASURED[run.parameters["density"]]
        cells = run.parameters["cells_per_diameter"]
        # 5 % below 16 cells a diameter, 2 % from there on: what is asked of the default scheme. E1 keeps 5 %: what
        # was measured is more than a sphere can reach in creeping flow through an endless duct of this width,
        # (ρₛ - ρ) g d²/18μ (1 - 1.9032 d/L + 2.05 (d/L)³) = 0.0356 m/s [Faxén], whatever the inertia takes off.
        tolerance = 0.02 if cells > 16 and name != "E1" else 0.05
        results.append(result(f"largest velocity, {name}, D/Δx = {cells:.3g}", -run.probes()["vz"].min(), "m/s",
                              reference, "ten Cate et al. 2002, ± 1 %", tolerance))
    return results


def main():
    run = Run(sys.argv[1])
    runs = [run, *studies(run).values()]
    run.write_results(judged(runs))
    figure, (speed, height) = plt.subplots(1, 2, figsize=(8.2, 3.2))
    for r in runs:
        name, reference = MEASURED[r.parameters["density"]]
        probe = r.probes()
        line, = speed.plot(probe["time"], probe["vz"], label=name)
        speed.axhline(-reference, color=line.get_color(), linewidth=0.8, linestyle=":")
        height.plot(probe["time"], (probe["z"] / r.parameters["diameter"] - 0.5), label=name)
    speed.set(xlabel="time [s]", ylabel="velocity [m/s], dotted: measured")
    height.set(xlabel="time [s]", ylabel="gap to the floor / diameter")
    speed.legend()
    run.save(figure, "history.png")
    frames = [f for f in run.frames() if f[0] > 0]
    chosen = frames[:: max(1, len(frames) // 4)][:4]
    figure, axes = plt.subplots(1, len(chosen), figsize=(2.1 * len(chosen), 3.4), sharey=True)
    for ax, (time, name) in zip(axes, chosen):
        image = draw_slice(ax, run, name, "y", vmax=-run.probes()["vz"].min())
        ax.set_title(f"t = {time:.2g} s")
    figure.colorbar(image, ax=axes, label="speed of the fluid [m/s]", fraction=0.03, pad=0.02)
    run.save(figure, "field.png")


if __name__ == "__main__":
    main()
