"""Tables and fields of an output folder: with names, units and coordinates, read when they are asked for."""

import numpy as np

UNIT_OF_COLUMN = {"time": "s", **dict.fromkeys(("x", "y", "z"), "m"),
                  **dict.fromkeys((f"{axis}{end}" for axis in "xyz" for end in (1, 2)), "m"),  # of a bond
                  **dict.fromkeys(("vx", "vy", "vz", "ux", "uy", "uz"), "m/s"),
                  **dict.fromkeys(("omega", "wx", "wy", "wz"), "rad/s"), **dict.fromkeys(("fx", "fy", "fz", "force"), "N"),
                  **dict.fromkeys(("torque", "tx", "ty", "tz"), "N m"), "pressure": "Pa", "radius": "m"}
UNIT_OF_FIELD = {"velocity": "m/s", "pressure": "Pa", "solid_fraction": "1", "image_fraction": "1", "viscosity": "m2/s"}
PARTICLE = {2: ("id", "x", "y", "radius", "vx", "vy", "omega", "type"),
            3: ("id", "x", "y", "z", "radius", "vx", "vy", "vz", "wx", "wy", "wz", "type")}
SLACK = 1e-6  # part of a length, for round-off in a place that is on the edge
BOND_STATES = ("intact", "broken by tension", "broken by shear")


class Table(dict):
    """Columns of equal length: name -> array, in SI units (`units`)."""

    said = {}  # name -> unit, as the file's first line has it; older files have none

    @property
    def units(self):
        """name -> unit; "1" for a plain number."""
        return {name: self.said.get(name, UNIT_OF_COLUMN.get(name, "1")) for name in self}

    def where(self, chosen):
        """The rows of a mask or of indices, as another Table."""
        part = Table({name: column[chosen] for name, column in self.items()})
        part.said = self.said
        return part

    def to_pandas(self):
        """A DataFrame, whose attrs["units"] are the units. Throws ImportError without pandas."""
        import pandas
        frame = pandas.DataFrame(dict(self))
        frame.attrs["units"] = self.units
        return frame

    def __repr__(self):
        rows = len(next(iter(self.values()), ()))
        return f"Table of {rows} rows: " + ", ".join(f"{name} [{unit}]" for name, unit in self.units.items())


def read_table(path):
    """Columns of a CSV file of ours: a Table, name -> array of numbers, or of words as the `mode` of a break."""
    with open(path) as file:
        heads = [column.rstrip("]").split(" [") for column in file.readline().strip().split(",")]
        lines = [line for line in file.read().splitlines() if line]
    names = [head[0] for head in heads]
    table = Table(zip(names, columns_of(lines) if lines else [np.zeros(0)] * len(names), strict=True))
    table.said = {head[0]: head[1] for head in heads if len(head) > 1}
    return table


def columns_of(lines):
    """Arrays of numbers, or of words where a column has any."""
    try:
        return np.loadtxt(lines, delimiter=",", ndmin=2).T
    except ValueError:  # there are words
        return map(numbers_or_words, zip(*(line.split(",") for line in lines), strict=True))


def numbers_or_words(column):
    try:
        return np.array([value or "nan" for value in column], float)  # an empty field is no number
    except ValueError:
        return np.array(column)


class Field:
    """An array over the cells, with what it is: values [nz][ny][nx], the last axis of a velocity its components.

    numpy takes it as the array; coordinates are those of the cells' centres [m].
    """

    def __init__(self, name, values, time, axes):
        self.name, self.values, self.time = name, values, time
        self.unit = UNIT_OF_FIELD.get(name, "1")
        self.coordinates = axes  # dict x, y (, z) -> centres
        self.dims = (*reversed(axes), "component")[:values.ndim]

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.values, dtype)

    def __getitem__(self, index):
        return self.values[index]

    @property
    def shape(self):
        return self.values.shape

    @property
    def speed(self):
        """Length of a vector at each cell, as another Field. Throws ValueError for a scalar."""
        if "component" not in self.dims:
            raise ValueError(f"{self.name} has no components")
        length = Field("speed", np.linalg.norm(self.values, axis=-1), self.time, self.coordinates)
        length.unit = self.unit
        return length

    def ends(self, axis):
        """Where the box begins and ends along an axis [m]; cells are cubes, as large as between two centres."""
        cell = next((float(c[1] - c[0]) for c in (self.coordinates[axis], *self.coordinates.values()) if len(c) > 1), np.inf)
        centres = self.coordinates[axis]
        return centres[0] - 0.5 * cell, centres[-1] + 0.5 * cell

    def at(self, **place):
        """Values of the cells nearest to places [m]: `at(x=0.01)` is a line (a plane in three dimensions), with all axes
        given a point. Throws ValueError for an axis that the box has not, and for a place outside of it."""
        values = self.values
        if unknown := [axis for axis in place if axis not in self.coordinates]:
            raise ValueError(f"{self.name} has no axis {unknown[0]}; it has {', '.join(self.coordinates)}")
        for axis, where in place.items():
            low, high = self.ends(axis)
            slack = SLACK * (high - low)
            if not low - slack <= where <= high + slack:
                raise ValueError(f"{axis} = {where:.6g} m is outside of the box, which lies between {low:.6g} and {high:.6g} m")
        for k in reversed(range(len(self.dims))):  # from the last axis on, so that the first ones keep their numbers
            if self.dims[k] in place:
                centres = self.coordinates[self.dims[k]]
                values = np.take(values, int(np.abs(centres - place[self.dims[k]]).argmin()), axis=k)
        return values

    def to_xarray(self):
        """A DataArray. Throws ImportError without xarray."""
        import xarray
        return xarray.DataArray(self.values, dims=self.dims, coords=self.coordinates, name=self.name,
                                attrs={"units": self.unit, "time": self.time})

    def __repr__(self):
        shape = ", ".join(f"{dim} {n}" for dim, n in zip(self.dims, self.shape, strict=True))
        return f"Field {self.name} [{self.unit}] at {self.time:.6g} s: {shape}"


def centres(file, cells):
    """Of the cells along x, y (, z) [m], in a file of fields of [nz][ny][nx] cells."""
    cell, about = file.attrs["cell"], dict(file.attrs)
    return {axis: about.get(f"origin_{axis}", 0.0) + cell * (np.arange(n) + 0.5)
            for axis, n in zip("xyz", reversed(cells))}  # noqa: B905  (two or three of them)


class Averages(dict):
    """What [average] has summed: name -> Field, as `averages.velocity_mean`; velocity_rms and pressure_rms are the root mean
    squares of what deviates. `averages["from"]`, `averages["to"]` [s] and `averages["samples"]` say over which time."""

    def __getattr__(self, name):
        if name not in self:
            raise AttributeError(f"the averages have no {name}; they have {', '.join(self)}")
        return self[name]

    def __repr__(self):
        fields = ", ".join(f"{name} [{field.unit}]" for name, field in self.items() if isinstance(field, Field))
        return f"Averages of {self['samples']:.0f} samples from {self['from']:.6g} to {self['to']:.6g} s: {fields}"


def read_averages(path):
    """Of an averages.h5."""
    import h5py
    with h5py.File(path) as file:
        axes, about = centres(file, file["pressure_mean"].shape), dict(file.attrs)
        found = Averages({name: Field(name, file[name][...], float(about["to"]), axes) for name in file})
        found.update({key: float(about[key]) for key in ("from", "to", "samples")})
        for name in file:
            found[name].unit = said if isinstance(said := file[name].attrs["unit"], str) else said.decode()
    return found


class Frame:
    """The fields and particles of one time. An array is read from the file when it is asked for."""

    def __init__(self, path, group, time):
        self.path, self.group, self.time = path, group, time

    def _read(self, name):
        import h5py
        with h5py.File(self.path) as file:
            if name not in file[self.group]:
                raise AttributeError(f"{self.path}, {self.time:.6g} s: there is no {name}; there are "
                                     + ", ".join(file[self.group]))
            return file[self.group][name][...]

    @property
    def coordinates(self):
        """Centres of the cells along x, y (, z) [m]."""
        import h5py
        with h5py.File(self.path) as file:
            return centres(file, file[self.group]["pressure"].shape)

    def middle(self, name):
        """The plane of cells in the middle of y of a field in three dimensions, [nz][nx]; no more is read from the file."""
        import h5py
        with h5py.File(self.path) as file:
            data = file[self.group][name]
            return data[:, data.shape[1] // 2]

    def _field(self, name):
        return Field(name, self._read(name), self.time, self.coordinates)

    @property
    def velocity(self):
        return self._field("velocity")

    @property
    def pressure(self):
        """Against rest and hydrostatic; not a number where a solid covers a cell whole."""
        return self._field("pressure")

    @property
    def solid_fraction(self):
        """Of the solids as the fluid sees them, whose radius differs a little from that of the particles (output.md)."""
        return self._field("solid_fraction")

    @property
    def viscosity(self):
        """Kinematic, of a scene with output.viscosity; not a number where a solid covers a cell whole."""
        return self._field("viscosity")

    @property
    def particles(self):
        """A Table: id, place, radius, velocity, angular velocity, type."""
        rows = self._read("particles")
        return Table(zip(PARTICLE[3 if rows.shape[1] > 8 else 2], rows.T))  # noqa: B905  (there may be more columns)

    @property
    def bonds(self):
        """A Table: both ends, and state (0 intact, 1 broken by tension, 2 by shear)."""
        ends = self._read("bond_ends")
        pairs = ends.reshape(-1, 2, ends.shape[1])
        columns = {f"{axis}{end + 1}": pairs[:, end, k] for end in (0, 1) for k, axis in enumerate("xyz"[:ends.shape[1]])}
        return Table({**columns, "state": self._read("bond_state").astype(int)})

    def __repr__(self):
        return f"Frame at {self.time:.6g} s of {self.path}"


class Frames:
    """The frames of a fields.h5, in the order of time; none where there is no such file."""

    def __init__(self, path):
        import h5py
        self.frames = []
        if path.is_file():
            with h5py.File(path) as file:
                self.frames = [Frame(path, name, float(file[name].attrs["time"])) for name in sorted(file)]

    @property
    def times(self):
        """[s]"""
        return np.array([frame.time for frame in self.frames])

    def at(self, time):
        """The frame nearest to a time [s]. Throws LookupError without any, and for a time that is further from the first or
        last than half of the time between two."""
        if not self.frames:
            raise LookupError("this run has no fields: output.fields_every is 0, or it ended before the first")
        first, last = self.times[[0, -1]]
        slack = 0.5 * np.diff(self.times).max(initial=SLACK * max(abs(first), abs(last)))
        if not first - slack <= time <= last + slack:
            raise LookupError(f"{time:.6g} s is outside of this run's fields, which were written from {first:.6g} to {last:.6g} s")
        return self.frames[int(np.abs(self.times - time).argmin())]

    def __len__(self):
        return len(self.frames)

    def __getitem__(self, index):
        return self.frames[index]
