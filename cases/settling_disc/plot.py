"""Results and pictures of settling_disc. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import pathlib
import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_snapshots, quantity, result, studies

# Maximum Reynolds number rho_s d U / mu in the literature: 17.27 (Glowinski et al. 2001, h = 1/192)
# to 17.42 (Wan and Turek 2006); their middle is the reference, 2 % of it the tolerance: half of the
# spread of the literature is 0.4 %, compressibility at Ma = 0.16 adds 0.5 %.
RE_LITERATURE = (17.27, 17.42)
RE_REFERENCE = 0.5 * sum(RE_LITERATURE)
RE_TOLERANCE = 0.02
# Case 2: 438 ... 503 in the literature.
RE_REFERENCE_2, RE_TOLERANCE_2 = 470.0, 0.08
# Density of the disc [kg/m³] and viscosity of the fluid [m²/s] of the two cases; those of others, as in a sweep, are not judged.
CASES = {1: (1250.0, 1e-5), 2: (1500.0, 1e-6)}


def case_of(run):
    """1 or 2, or None of another disc or fluid."""
    p = run.parameters
    return next((case for case, values in CASES.items()
                 if np.allclose((p["particle_density"], p["kinematic_viscosity"]), values, rtol=1e-9, atol=0)), None)


def reynolds(run):
    """rho_s d |v| / mu against time."""
    p, probe = run.parameters, run.probes()
    mu = p["density"] * p["kinematic_viscosity"]
    return probe["time"], p["particle_density"] * p["diameter"] * -probe["vy"] / mu


def judged(run, others):
    p, probe = run.parameters, run.probes()
    case = case_of(run)
    if case is None:
        return []
    if case == 2:
        return [result("Re_max", reynolds(run)[1].max(), "1", RE_REFERENCE_2,
                       "Glowinski et al. 2001 and others: 438 ... 503", RE_TOLERANCE_2)]
    runs = [run] + [r for name, r in others.items() if "inertia" not in name]
    results = [result(f"Re_max at D/Δx = {r.parameters['cells_per_diameter']:.0f}",
                      reynolds(r)[1].max(), "1", RE_REFERENCE,
                      "Glowinski et al. 2001, Wan and Turek 2006: 17.27 ... 17.42", RE_TOLERANCE)
               for r in runs]
    if run.summary["physical_seconds"] > 0.95:
        radius = 0.5 * p["diameter"]
        results.append(result("height at rest", probe["y"][-1], "m", radius,
                              "disc touches the floor; 1 % of a radius allows for contact overlap",
                              0.01))
        results.append(result("speed at rest", probe["vy"][-1], "m/s", 0.0,
                              "rests; 0.1 % of the largest speed", 0.001,
                              scale=np.abs(probe["vy"]).max()))
    return results


def picture_history(run, others):
    p, probe = run.parameters, run.probes()
    weight = p["particle_density"] * np.pi / 4 * p["diameter"] ** 2 * p["depth"] * -p["gravity_y"]
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(6.4, 5.2), sharex=True)
    if case_of(run) == 1:
        top.axhspan(*RE_LITERATURE, color="0.8", label="literature, maximum")
    top.plot(*reynolds(run), label=f"D/Δx = {p['cells_per_diameter']:.0f}")
    for name, other in others.items():
        label = ("without the inner fluid's inertia" if "inertia" in name
                 else f"D/Δx = {other.parameters['cells_per_diameter']:.0f}")
        top.plot(*reynolds(other), "--", linewidth=1, label=label)
    top.set_ylabel("Re = ρₛ d |v| / μ")
    top.legend(loc="lower center")
    bottom.plot(probe["time"], probe["fy"] / weight)
    bottom.axhline(1, color="0.5", linewidth=0.8)
    bottom.set_ylim(0.6, 1.4)
    bottom.set_ylabel("force of the fluid / weight")
    bottom.set_xlabel("time [s]")
    run.save(figure, "history.png")


def picture_resolution(run, others):
    runs = [run] + [r for name, r in others.items() if "inertia" not in name]
    if len(runs) < 2:
        return
    runs.sort(key=lambda r: r.parameters["cells_per_diameter"])
    cells = [r.parameters["cells_per_diameter"] for r in runs]
    errors = [100 * (reynolds(r)[1].max() / RE_REFERENCE - 1) for r in runs]
    half = 100 * (RE_LITERATURE[1] / RE_REFERENCE - 1)
    figure, ax = plt.subplots(figsize=(5.4, 3.4))
    ax.axhspan(-100 * RE_TOLERANCE, 100 * RE_TOLERANCE, color="0.92", label="tolerance")
    ax.axhspan(-half, half, color="0.8", label="spread of the literature")
    ax.plot(cells, errors, "o-", label="BPLBM")
    for r, x, y in zip(runs, cells, errors):
        ax.annotate(f"{r.summary['cpu_seconds']:.2g} CPU s", (x, y), textcoords="offset points",
                    xytext=(0, 9), ha="center")
    ax.set_xticks(cells)
    ax.set_xlim(0, 1.12 * max(cells))
    ax.set_xlabel("cells across the diameter")
    ax.set_ylabel("error of the largest Re [%]")
    ax.set_ylim(-4, 4)
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=3)
    figure.tight_layout()
    run.save(figure, "resolution.png")


def fall_deficit(run, other, time=0.4):
    """By how much shorter the disc of `other` fell until `time`, relative."""
    fallen = []
    for r in (run, other):
        probe = r.probes()
        fallen.append(probe["y"][0] - np.interp(time, probe["time"], probe["y"]))
    return 1 - fallen[1] / fallen[0]


def main():
    run = Run(pathlib.Path(sys.argv[1]))
    others = studies(run)
    run.write_results(judged(run, others), [] if case_of(run) == 2 else [quantity("Re_max", reynolds(run)[1].max(), "1")])
    draw_snapshots(run, (0.05, 0.2, 0.4, 0.6, 0.75, 1.0), 1.05 * np.abs(run.probes()["vy"]).max())
    picture_history(run, others)
    picture_resolution(run, others)
    for name, other in others.items():
        if "inertia" in name:
            print(f"run | note | without the inner fluid's inertia the disc falls "
                  f"{100 * fall_deficit(run, other):.1f} % less far in 0.4 s")


if __name__ == "__main__":
    main()
