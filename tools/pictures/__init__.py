"""Reading a run's output folder, judging results, and drawing in one style."""

import json
import pathlib

import h5py
import matplotlib.pyplot as plt
import numpy as np

plt.rcParams.update({
    "figure.dpi": 130, "font.size": 9, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.alpha": 0.25, "legend.frameon": False, "lines.linewidth": 1.4,
})


def read_table(path):
    """Columns of a CSV file of ours: dict name -> array."""
    rows = np.atleast_1d(np.genfromtxt(path, delimiter=",", names=True))
    return {name: rows[name] for name in rows.dtype.names}


def studies(run):
    """The comparison runs beside a run, by name of their folder."""
    return {f.name: Run(f) for f in sorted((run.folder / "study").glob("*"))
            if (f / "summary.json").exists()}


class Run:
    """The output folder of one run."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.summary = json.loads((self.folder / "summary.json").read_text())
        self.parameters = self.summary["parameters"]

    def probes(self, particle=1):
        """Columns of probes.csv of one particle: dict name -> array, SI units."""
        table = read_table(self.folder / "probes.csv")
        mine = table["id"] == particle
        return {name: column[mine] for name, column in table.items()}

    def frames(self):
        """Times and names of the field frames."""
        with h5py.File(self.folder / "fields.h5") as f:
            return [(f[name].attrs["time"], name) for name in sorted(f)]

    def frame(self, name):
        """One frame: velocity [ny][nx][3], pressure [ny][nx], particles [n][8], SI units."""
        with h5py.File(self.folder / "fields.h5") as f:
            return {key: f[name][key][...] for key in f[name]}

    def save(self, figure, name):
        figure.savefig(self.folder / name, bbox_inches="tight")
        plt.close(figure)

    def write_results(self, results):
        """Puts results into summary.json, whole or not at all."""
        self.summary["results"] = results
        part = self.folder / "summary.json.part"
        part.write_text(json.dumps(self.summary, indent=2) + "\n")
        part.replace(self.folder / "summary.json")


def result(name, value, unit, reference, source, tolerance, scale=None):
    """A judged number. error = (value - reference) / scale; scale defaults to the reference."""
    value, reference = float(value), float(reference)
    error = (value - reference) / (abs(reference) if scale is None else scale)
    return {"name": name, "value": value, "unit": unit, "reference": reference, "source": source,
            "error": error, "tolerance": tolerance, "pass": bool(abs(error) <= tolerance)}


def draw_speed(axes, run, name, vmax, length_unit=1e-2):
    """Colour map of the fluid's speed with the particles on it. Returns the image."""
    frame = run.frame(name)
    p = run.parameters
    speed = np.hypot(frame["velocity"][..., 0], frame["velocity"][..., 1])
    extent = [0, p["box_x"] / length_unit, 0, p["box_y"] / length_unit]
    image = axes.imshow(speed, origin="lower", extent=extent, cmap="magma", vmin=0, vmax=vmax)
    for _, x, y, radius, *_ in frame["particles"]:
        axes.add_patch(plt.Circle((x / length_unit, y / length_unit), radius / length_unit,
                                  facecolor="white", edgecolor="black", linewidth=0.8))
    axes.grid(False)
    return image
