"""Results and picture of lid_driven_cavity. Usage: plot.py OUT_FOLDER (tools/run calls it)."""

import sys

import matplotlib.pyplot as plt
import numpy as np
from bplbm import Run, result

# Ghia, Ghia and Shin 1982, tables I and II: u on the vertical, v on the horizontal centre line.
GHIA = {
    100: ({.1719: -.10150, .4531: -.21090, .5: -.20581, .7344: .00332}, {}),
    1000: ({.0547: -.18109, .1719: -.38289, .2813: -.27805, .5: -.06080, .8516: .33304, .9531: .46604},
           {.1563: .37095, .5: .02526, .9063: -.51550}),
    5000: ({.0547: -.41165, .0703: -.43643, .1016: -.40435, .1719: -.33050, .2813: -.22855, .4531: -.07404,
            .5: -.03039, .6172: .08183, .7344: .20087, .8516: .33556, .9531: .46036, .9766: .48223},
           {.0625: .42447, .0781: .43648, .0938: .42951, .1563: .35368, .2266: .28066, .5: .00945,
            .8047: -.30018, .8594: -.36214, .9063: -.41442, .9453: -.52876, .9531: -.55408, .9688: -.49774}),
}
# Of the lid's speed. At 129 cells half of what stair-step codes of this size show; at Re 5000 and 257 cells the
# reference's own grid leaves about a hundredth at the extremes.
TOLERANCE = {5000: 0.02}


def main():
    run = Run(sys.argv[1])
    reynolds = round(1 / run.parameters["kinematic_viscosity"])
    velocity = run.frame(run.frames()[-1][1])["velocity"].astype(float)
    n = velocity.shape[0]
    at = (np.arange(n) + 0.5) / n
    middle = n // 2
    u = velocity[:, middle, 0] if n % 2 else velocity[:, middle - 1:middle + 1, 0].mean(axis=1)
    v = velocity[middle, :, 1] if n % 2 else velocity[middle - 1:middle + 1, :, 1].mean(axis=0)
    reference = GHIA.get(reynolds, ({}, {}))
    results = [result(f"{name} at {place}", np.interp(place, at, profile), "U", value,
                      "Ghia, Ghia and Shin 1982", TOLERANCE.get(reynolds, 0.01), scale=1.0)
               for name, profile, table in (("u", u, reference[0]), ("v", v, reference[1]))
               for place, value in table.items()]
    speed = np.hypot(velocity[..., 0], velocity[..., 1])
    results.append(result("fastest cell beyond the lid's speed", max(0.0, speed.max() - 1.0), "U", 0.0,
                          "nothing drives the fluid but the lid", 0.02, scale=1.0))
    if not run.summary["ending"].startswith("steady"):
        results.append(result("turnovers", run.summary["physical_seconds"], "1", 200.0,
                              "bounded to the end", 1e-6))
    run.write_results(results)
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.6))
    left.imshow(speed, origin="lower", extent=[0, 1, 0, 1], cmap="magma", vmin=0, vmax=1)
    left.streamplot(at, at, velocity[..., 0], velocity[..., 1], color="w", linewidth=0.4, density=1.3,
                    arrowsize=0.5)
    left.grid(False)
    left.set_title(f"Re = {reynolds}, {n} cells")
    right.plot(at, u, label="u(y) at x = ½")
    right.plot(at, v, label="v(x) at y = ½")
    for table in reference:
        right.plot(list(table), list(table.values()), "k.", markersize=6)
    right.set_xlabel("y, x")
    right.legend(title="dots: Ghia et al.")
    run.save(figure, "cavity.png")


if __name__ == "__main__":
    main()
