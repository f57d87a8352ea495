"""Obstacles that come from files, for drawings: meshes as they lie in the box, and images as solid fractions."""

import pathlib

import numpy as np

RAW = {"uint8": "<u1", "int8": "<i1", "bool": "<u1", "uint16": "<u2", "int16": "<i2", "uint32": "<u4", "int32": "<i4",
       "float32": "<f4", "float64": "<f8"}


def read_stl(path):
    """Corners [triangle][3][3] of a binary or ASCII .stl file, in the file's unit. Throws ValueError: what is wrong with it."""
    data = pathlib.Path(path).read_bytes()
    count = int.from_bytes(data[80:84], "little") if len(data) >= 84 else 0
    if count > 0 and len(data) == 84 + 50 * count:
        facets = np.frombuffer(data, dtype=[("floats", "<f4", 12), ("attribute", "<u2")], offset=84)
        corners = facets["floats"].reshape(-1, 4, 3)[:, 1:].astype(float)
    elif b"facet" not in data or b"\0" in data:
        announced = f" where its header announces {count} facets, {84 + 50 * count} bytes" if len(data) >= 84 else " and no 'facet'"
        raise ValueError(f"{path} has {len(data)} bytes{announced}; give a whole .stl file, binary or ASCII")
    else:
        words = [line.split() for line in data.decode(errors="replace").splitlines()]
        vertices = [word[1:4] for word in words if word[:1] == ["vertex"]]
        if not vertices or len(vertices) % 3:
            raise ValueError(f"{path} holds {len(vertices)} corners, which are no triangles; give three a facet: is the file whole?")
        try:
            corners = np.array([[float(v) for v in vertex] for vertex in vertices]).reshape(-1, 3, 3)
        except ValueError:
            raise ValueError(f"{path} has a corner that is not three numbers; give a whole .stl file, binary or ASCII") from None
    if not np.isfinite(corners).all():
        raise ValueError(f"{path} has corners that are not finite; give finite numbers")
    return corners


def placed_mesh(obstacle, folder):
    """Corners [m] of a mesh obstacle: scaled, turned, moved."""
    corners = read_stl(pathlib.Path(folder) / obstacle["mesh"]) * obstacle.get("scale", 1.0)
    *axis, degrees = obstacle.get("rotate", [0.0, 0.0, 1.0, 0.0])
    axis, angle = np.array(axis) / np.linalg.norm(axis), np.radians(degrees)
    turned = np.cos(angle) * corners + np.sin(angle) * np.cross(axis, corners) + \
        (1 - np.cos(angle)) * (corners @ axis)[..., None] * axis
    return turned + np.array(obstacle.get("move", [0.0, 0.0, 0.0]))


def extent(obstacle, folder):
    """Lower and upper corner of what bounds a disc, sphere, block or mesh, and of a cylinder's axis [m]."""
    if "mesh" in obstacle:
        corners = placed_mesh(obstacle, folder).reshape(-1, 3)
        return corners.min(0), corners.max(0)
    if "centre" in obstacle:
        centre = np.array(obstacle["centre"], dtype=float)
        return centre - 0.5 * obstacle["diameter"], centre + 0.5 * obstacle["diameter"]
    ends = np.array([obstacle["from"], obstacle["to"]], dtype=float)
    return ends.min(0), ends.max(0)


def facing(corners):
    """Triangles of a mesh that face whoever looks along y, seen from y = 0; the nearest last."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    seen = corners[a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2] < 0]
    return seen[np.argsort(-seen[:, :, 1].mean(1), kind="stable")]


def section(corners, place):
    """Lines [n][2][3] in which the plane y = place cuts the triangles of a mesh."""
    below = corners[:, :, 1] < place
    crossed = below.any(1) & ~below.all(1)
    corners, below = corners[crossed], below[crossed]
    alone = np.where(below.sum(1) == 1, below.argmax(1), (~below).argmax(1))  # the corner with none beside it
    rows = np.arange(len(corners))
    tip = corners[rows, alone]
    ends = []
    for other in (corners[rows, (alone + 1) % 3], corners[rows, (alone + 2) % 3]):
        part = (place - tip[:, 1]) / (other[:, 1] - tip[:, 1])
        ends.append(tip + part[:, None] * (other - tip))
    return np.stack(ends, axis=1)


def grey_levels(obstacle, folder):
    """Levels [z][y][x] or [y][x] of the file of an image obstacle, y upwards."""
    path = pathlib.Path(folder) / obstacle["image"]
    kind = path.suffix.lower()
    if kind == ".raw":
        return np.fromfile(path, RAW[obstacle["raw_type"]]).reshape(obstacle["raw_size"][::-1])
    if kind == ".npy":
        return np.load(path)
    if kind in (".h5", ".hdf5"):
        import h5py  # the others do without
        with h5py.File(path) as file:
            return file[obstacle["dataset"]][...]
    from PIL import Image, ImageSequence  # comes with matplotlib
    with Image.open(path) as picture:
        pages = np.stack([np.array(page)[::-1] for page in ImageSequence.Iterator(picture)])
    return pages[0] if len(pages) == 1 else pages


def solid_fraction(obstacle, folder):
    """Solid fractions [z][y][x] or [y][x] of an image obstacle, cut as the scene says."""
    levels = grey_levels(obstacle, folder).astype(float)
    begin, end = obstacle.get("cut_from"), obstacle.get("cut_to")
    sizes = levels.shape[::-1]
    cut = [slice(begin[k] if begin else 0, end[k] if end else sizes[k]) for k in range(min(levels.ndim, len(begin or end or sizes)))]
    levels = levels[tuple(cut[::-1])]
    if "threshold" in obstacle:
        return ((levels >= obstacle["threshold"]) == (obstacle.get("solid", "above") == "above")).astype(float)
    fluid, solid = obstacle["grey_levels"]
    return np.clip((levels - fluid) / (solid - fluid), 0.0, 1.0)


def image_extent(obstacle, fractions, origin):
    """[x0, x1, y0, y1] in two dimensions, in three also z0, z1 [m]."""
    low = np.array(obstacle.get("at", origin), dtype=float)[:fractions.ndim]
    high = low + obstacle["voxel"] * np.array(fractions.shape[::-1])
    return [edge for pair in zip(low, high) for edge in pair]
