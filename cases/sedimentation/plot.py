"""Results and pictures of sedimentation. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, draw_snapshots, quantity, result, studies

FALLING = (8e-3, 15e-3)  # m: heights between which the terminal velocity is taken
# Another code at D/Δx = 25, as a value to stay near to: the paper gives figures only.
TERMINAL = 0.267


def terminal(run):
    """Mean and standard deviation of -v_y between the two heights."""
    probe = run.probes()
    v = -probe["vy"][(probe["y"] > FALLING[0]) & (probe["y"] < FALLING[1])]
    return v.mean(), v.std()


def weight(run):
    p = run.parameters
    return p["particle_density"] * np.pi / 4 * p["diameter"] ** 2 * p["depth"] * -p["gravity_y"]


def noise(run, period=2e-3):
    """rms of the force's quick part over the weight: what a running mean of 2 ms takes away, from
    20 ms after the start to 5 mm above the floor."""
    probe = run.probes()
    n = max(3, round(period / run.parameters["interval"]))
    force = probe["fy"][:-1]  # the last row repeats the load before
    quick = force[n // 2:len(force) - (n - 1 - n // 2)] - np.convolve(force, np.ones(n) / n, "valid")
    inside = slice(n // 2, len(force) - (n - 1 - n // 2))
    calm = (probe["time"][:-1][inside] > 0.02) & (probe["y"][:-1][inside] > 5e-3)
    return np.sqrt(np.mean(quick[calm] ** 2)) / weight(run)


def judged(run, others):
    p, probe = run.parameters, run.probes()
    radius = 0.5 * p["diameter"]
    results = [
        # 10 %: one other code at the same resolution, not a reference solution
        result("terminal velocity", terminal(run)[0], "m/s", TERMINAL,
               "another code at D/Δx = 25 (regression value)", 0.1),
        result("force noise over weight", noise(run), "1", 0.0, "smooth force; 5 % is the limit", 0.05,
               scale=1.0)]
    if run.summary["physical_seconds"] > 0.235:
        results += [result("height at rest", probe["y"][-1], "m", radius,
                           "on the floor; 1 % of a radius allows for contact overlap", 0.01),
                    result("speed at rest", probe["vy"][-1], "m/s", 0.0,
                           "rests; 1 % of the terminal velocity", 0.01, scale=TERMINAL)]
    return results


def label(name, run):
    words = name.removeprefix("variant-").replace("_", " ") if name.startswith("variant-") else ""
    return words or f"D/Δx = {run.parameters['cells_per_diameter']:.4g}"


def main():
    run = Run(sys.argv[1])
    others = studies(run)
    mean, sigma = terminal(run)
    run.write_results(judged(run, others), [quantity("terminal velocity", mean, "m/s"),
                                            quantity("its spread", sigma, "m/s"),
                                            quantity("force noise over weight", noise(run), "1")])
    for name, r in {"resolved": run, **others}.items():
        mean, sigma = terminal(r)
        print(f"run | note | {name}: terminal velocity {mean:.4f} ± {sigma:.4f} m/s, force noise "
              f"{100 * noise(r):.1f} % of the weight, {r.summary['cpu_seconds']:.3g} CPU s")
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(6.6, 5.6), sharex=True)
    compared = {"IMB (default)": run}
    if "variant-implicit_immersed_boundary" in others:
        compared["implicit IBM"] = others["variant-implicit_immersed_boundary"]
    for name, r in compared.items():
        probe = r.probes()
        top.plot(probe["time"], -probe["vy"], label=name)
        bottom.plot(probe["time"], probe["fy"] / weight(r), label=name, linewidth=0.7)
    for name in ("variant-coarse", "set-fine"):
        if name in others:
            probe = others[name].probes()
            top.plot(probe["time"], -probe["vy"], "--", linewidth=0.8, label=label(name, others[name]))
    top.set_ylabel("falling velocity [m/s]")
    top.legend()
    bottom.axhline(1, color="0.5", linewidth=0.8)
    bottom.set_ylim(-0.5, 2.5)
    bottom.set_ylabel("force of the fluid / weight")
    bottom.set_xlabel("time [s]")
    run.save(figure, "fall.png")

    draw_snapshots(run, (0.02, 0.06, 0.1, 0.14, 0.18, 0.24), 0.4, length_unit=1e-3)


if __name__ == "__main__":
    main()
