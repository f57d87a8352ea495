"""Reading a run's output folder, and judging results."""

import json
import pathlib

import h5py
import numpy as np

from bplbm.reading import Frames, read_table


def studies(run):
    """The comparison runs beside a run, by name of their folder."""
    return {f.name: Run(f) for f in sorted((run.folder / "study").glob("*"))
            if (f / "summary.json").exists()}


class Run:
    """The output folder of one run: summary and parameters at once, all else when it is asked for."""

    def __init__(self, folder):
        """Throws OSError where there is no summary.json: the run has not come to its end."""
        self.folder = pathlib.Path(folder)
        self.summary = json.loads((self.folder / "summary.json").read_text())
        self.parameters = self.summary["parameters"]

    def probes(self, particle=1):
        """Columns of probes.csv of one particle: dict name -> array, SI units."""
        table = read_table(self.folder / "probes.csv")
        mine = table["id"] == particle
        return {name: column[mine] for name, column in table.items()}

    def table(self, name):
        """probes, points, obstacles or breaks (any CSV file of the folder): a pandas DataFrame where pandas is installed,
        else a Table, name -> array; SI units, in `.attrs["units"]` or `.units`. Throws OSError where there is none."""
        table = read_table(self.folder / f"{name}.csv")
        try:
            return table.to_pandas()
        except ImportError:
            return table

    @property
    def breaks(self):
        """Each broken bond: step, time, ids, mode, force, place, direction; as `table`."""
        return self.table("breaks")

    @property
    def fields(self):
        """Frames of the fields: `run.fields[-1].pressure`, `run.fields.at(0.4).velocity`."""
        return Frames(self.folder / "fields.h5")

    @property
    def averages(self):
        """What [average] has summed: dict velocity_mean, velocity_rms [m/s], pressure_mean, pressure_rms [Pa] -> array, and
        `from`, `to` [s] and `samples`. Throws OSError where there is none."""
        with h5py.File(self.folder / "averages.h5") as f:
            return {**{name: f[name][...] for name in f}, **{key: f.attrs[key] for key in ("from", "to", "samples")}}

    @property
    def results(self):
        """Judged results: dicts with name, value, unit, reference, error, tolerance, pass."""
        return self.summary["results"]

    @property
    def quantities(self):
        """Numbers without a reference: dicts with name, value, unit."""
        return self.summary.get("quantities", [])

    @property
    def studies(self):
        """The comparison runs beside it: dict name -> Run."""
        return studies(self)

    def __repr__(self):
        s = self.summary
        passed = sum(r["pass"] is True for r in self.results)
        judged = f"not judged: {s['not_judged']}" if "not_judged" in s else f"{passed} of {len(self.results)} results pass"
        return f"Run of {s['scene']}: {s['steps']} steps, {s['physical_seconds']:.6g} s{', ' + judged if self.results else ''} ({self.folder})"

    def frames(self):
        """Times and names of the field frames."""
        with h5py.File(self.folder / "fields.h5") as f:
            return [(f[name].attrs["time"], name) for name in sorted(f)]

    def frame(self, name):
        """One frame: velocity [ny][nx][3], pressure [ny][nx], particles [n][8], SI units."""
        with h5py.File(self.folder / "fields.h5") as f:
            return {key: f[name][key][...] for key in f[name]}

    def mean_velocity(self, name):
        """Mean over the box of the velocity of a frame [m/s], its components: in steady flow the flux, covered cells or not,
        with the solid terms by resistance, which are the default (lbm_solver/docs/resistance.md)."""
        with h5py.File(self.folder / "fields.h5") as f:
            velocity = np.asarray(f[name]["velocity"], float)
        return velocity.reshape(-1, velocity.shape[-1]).mean(axis=0)

    def flux(self, name):
        """Mean over the box of the momentum that arrives in the cells, over the density [m/s], its components: in steady flow
        the flux, covered cells or not, with every solid term. An empty list where a scene has no covered cells."""
        with h5py.File(self.folder / "fields.h5") as f:
            return [f[name].attrs[f"flux_{axis}"] for axis in "xyz" if f"flux_{axis}" in f[name].attrs]

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
    """A CSV file of columns of equal length: dict "name [unit]" -> array."""
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns),
               comments="", fmt="%.8g", encoding="utf-8")
