"""Reading a run's output folder, and judging results."""

import json
import pathlib

import h5py
import numpy as np

from bplbm.mpi_job import reason_of
from bplbm.reading import Frames, read_averages, read_table


ASKED_BY = {"averages.h5": "[average]", "fields.h5": "output.fields_every"}


def why_no_run(folder):
    """Why a folder holds no run that came to its end, and what to look at."""
    if not folder.is_dir():
        beside = sorted(p.parent.name for p in folder.parent.glob("*/summary.json"))
        return f"there is no folder {folder}" + (f"; in {folder.parent} there are: {', '.join(beside)}" if beside else "")
    log = folder / "error.log"
    if log.is_file():
        return f"{folder}: this run has failed (there is no summary.json): {reason_of(log.read_text(errors='replace'))}; {log} holds all " \
               "that was said"
    runs = sorted(p.parent.name for p in folder.glob("*/summary.json"))
    return f"{folder} holds no run that came to its end (there is no summary.json)" + \
        (f"; these in it do: {', '.join(runs)}" if runs else "; is it still at work? Its lbm.log says how far it is")


def studies(run):
    """The comparison runs beside a run, by name of their folder."""
    return {f.name: Run(f) for f in sorted((run.folder / "study").glob("*"))
            if (f / "summary.json").exists()}


def fall_in_layers(run, rows):
    """Velocity of particles downward (-z) against the mixture around them [m/s], [rows]: what the layers of cells that one
    lies in across y have on the mean, over x, z and its volume. Covered cells have the particles' velocity.
    rows: columns time, y, vz of probes of spheres of one diameter. A run without fields or in 2D has no layers: ValueError."""
    frames = list(run.fields)
    if not frames or np.ndim(frames[0].velocity) != 4:
        raise ValueError(f"{run.folder}: no fields of three dimensions; give output.fields_every")
    times = [frame.time for frame in frames]
    layers = np.array([np.asarray(frame.velocity)[..., 2].mean(axis=(0, 2)) for frame in frames])
    y = run.parameters["box_y"] * (np.arange(layers.shape[1]) + 0.5) / layers.shape[1]
    points, weights = np.polynomial.legendre.leggauss(12)
    weights = weights * (1 - points**2) / np.sum(weights * (1 - points**2))
    fall = -np.asarray(rows["vz"], dtype=float)
    for time in np.unique(rows["time"]):
        now = rows["time"] == time
        mixture = [np.interp(time, times, layer) for layer in layers.T]
        fall[now] += np.interp(rows["y"][now][:, None] + 0.5 * run.parameters["diameter"] * points, y, mixture) @ weights
    return fall


class Run:
    """The output folder of one run: summary and parameters at once, all else when it is asked for."""

    def __init__(self, folder):
        """Throws FileNotFoundError where there is no summary.json, and says why: the run has not come to its end."""
        self.folder = pathlib.Path(folder)
        if not (self.folder / "summary.json").is_file():
            raise FileNotFoundError(why_no_run(self.folder))
        self.summary = json.loads((self.folder / "summary.json").read_text())
        self.parameters = self.summary["parameters"]

    def probes(self, particle=1):
        """Columns of probes.csv of one particle: a Table, name -> array, SI units in `.units`. Throws LookupError where it has no such one."""
        table = read_table(self.file("probes.csv"))
        mine = table["id"] == particle
        if not mine.any():
            ids = np.unique(table["id"]).astype(int)
            there = f"they are {ids[0]} … {ids[-1]}" if len(ids) else "there are none"
            raise LookupError(f"{self.folder / 'probes.csv'} has no particle {particle}; {there}")
        return table.where(mine)

    def table(self, name):
        """probes, points, obstacles, breaks or sensor-NAME (any CSV file of the folder): a pandas DataFrame where pandas is
        installed, else a Table, name -> array; SI units, in `.attrs["units"]` or `.units`. Throws FileNotFoundError where
        there is none, and says which there are."""
        table = read_table(self.file(f"{name}.csv"))
        try:
            return table.to_pandas()
        except ImportError:
            return table

    def file(self, name):
        """The path of a file of the run. Throws FileNotFoundError, and says which of its kind there are."""
        path = self.folder / name
        if path.is_file():
            return path
        there = sorted(p.name for p in self.folder.glob(f"*{path.suffix}"))
        if path.suffix == ".csv":
            found = f"its tables are: {', '.join(p.removesuffix('.csv') for p in there) or 'none'}"
        else:
            found = f"the scene asks for it with {ASKED_BY[name]}" if name in ASKED_BY else f"there are: {', '.join(there) or 'none'}"
        raise FileNotFoundError(f"{self.folder} has no {name}; {found}")

    @property
    def sensors(self):
        """The table of each [[sensor]]: dict name -> as `table`."""
        return {path.stem.removeprefix("sensor-"): self.table(path.stem) for path in sorted(self.folder.glob("sensor-*.csv"))}

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
        """What [average] has summed: velocity_mean, velocity_rms, pressure_mean, pressure_rms as Fields, by name or as
        `averages.velocity_mean`, and `from`, `to` [s] and `samples`. Throws FileNotFoundError where there is none."""
        return read_averages(self.file("averages.h5"))

    @property
    def results(self):
        """Judged results: dicts with name, value, unit, reference, error, tolerance, pass."""
        return self.summary["results"]

    @property
    def quantities(self):
        """Numbers without a reference: dicts with name, value, unit; those of every run, and those of the scene's plot.py,
        which replace them by name."""
        from bplbm.quantities import default_quantities  # it needs this module
        return list({q["name"]: q for q in [*default_quantities(self), *self.summary.get("quantities", [])]}.values())

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
        with h5py.File(self.file("fields.h5")) as f:
            return [(f[name].attrs["time"], name) for name in sorted(f)]

    def frame(self, name):
        """One frame: velocity [ny][nx][3], pressure [ny][nx], particles [n][8], SI units."""
        with h5py.File(self.file("fields.h5")) as f:
            return {key: f[name][key][...] for key in f[name]}

    def mean_velocity(self, name):
        """Mean over the box of the velocity of a frame [m/s], its components: in steady flow the flux, covered cells or not,
        with the solid terms by resistance, which are the default (lbm_solver/docs/resistance.md)."""
        with h5py.File(self.file("fields.h5")) as f:
            velocity = np.asarray(f[name]["velocity"], float)
        return velocity.reshape(-1, velocity.shape[-1]).mean(axis=0)

    def flux(self, name):
        """Mean over the box of the momentum that arrives in the cells, over the density [m/s], its components: in steady flow
        the flux, covered cells or not, with every solid term. An empty list where a scene has no covered cells."""
        with h5py.File(self.file("fields.h5")) as f:
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
