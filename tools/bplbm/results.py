"""Reading a run's output folder, and judging results."""

import json
import pathlib

import h5py
import numpy as np


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
        """Writes a picture into the folder, and closes its figure."""
        from matplotlib import pyplot
        figure.savefig(self.folder / name, bbox_inches="tight")
        pyplot.close(figure)

    def write_results(self, results, quantities=()):
        """Puts judged results, and quantities to know, into summary.json, whole or not at all."""
        self.summary["results"] = results
        self.summary["quantities"] = list(quantities)
        part = self.folder / "summary.json.part"
        part.write_text(json.dumps(self.summary, indent=2) + "\n")
        part.replace(self.folder / "summary.json")


def result(name, value, unit, reference, source, tolerance, scale=None):
    """A judged number. error = (value - reference) / scale; scale defaults to the reference."""
    value, reference = float(value), float(reference)
    error = (value - reference) / (abs(reference) if scale is None else scale)
    return {"name": name, "value": value, "unit": unit, "reference": reference, "source": source,
            "error": error, "tolerance": tolerance, "pass": bool(abs(error) <= tolerance)}


def quantity(name, value, unit):
    """A number that is told, not judged: there is no reference for it."""
    return {"name": name, "value": float(value), "unit": unit}


def write_table(path, columns):
    """A CSV file of columns of equal length: dict name -> array."""
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns),
               comments="", fmt="%.8g")
