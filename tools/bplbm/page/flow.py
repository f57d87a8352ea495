"""The animation of a page: speed, pressure and viscosity of the fluid, particles and bonds over it, moved by a slider."""

import json
from dataclasses import dataclass

import numpy as np

from bplbm.page.picture import HOT, MOST_MARKS, TWO_SIDED, Scale, chosen_frames, coarser, data_url, png

UNITS = 1000  # of the drawing over a picture: along the longer side
LABELS = {"speed": "speed [m/s]", "pressure": "pressure [Pa]", "viscosity": "log₁₀ of the viscosity [m²/s]"}


@dataclass(frozen=True)
class Plane:
    """What is drawn of a frame: fields [up][across], particles across, up, radius [m], and bonds."""

    time: float
    speed: np.ndarray
    pressure: np.ndarray
    discs: np.ndarray  # [n][3]
    bonds: np.ndarray  # [n][5]: both ends, state
    fluid: tuple  # mean and largest speed [m/s]
    viscosity: np.ndarray | None = None  # log₁₀ of it [m²/s], where the run has written it


def cut(frame, size):
    """The frame in two dimensions, or its middle plane normal to y in three."""
    read = frame.middle if len(size) == 3 else lambda name: getattr(frame, name).values
    speed, pressure = np.linalg.norm(read("velocity"), axis=-1), read("pressure")
    speed = np.where(np.isfinite(pressure), speed, np.nan)  # there is no pressure where a solid covers a cell whole
    seen = speed[np.isfinite(speed)]
    fluid = (float(seen.mean()), float(seen.max())) if len(seen) else (0.0, 0.0)
    return Plane(frame.time, speed, pressure, discs_of(frame, size), bonds_of(frame) if len(size) == 2 else np.zeros((0, 5)),
                 fluid, viscosity_of(read))


def viscosity_of(read):
    try:
        return np.log10(read("viscosity"))
    except (AttributeError, KeyError):
        return None


def discs_of(frame, size):
    try:
        p = frame.particles
    except AttributeError:
        return np.zeros((0, 3))
    if len(size) == 2:
        return np.column_stack([p["x"], p["y"], p["radius"]])[p["radius"] > 0]  # the carrier of a clump has none
    depth = p["y"] - float(frame.coordinates["y"].mean())
    cuts = np.abs(depth) < p["radius"]
    return np.column_stack([p["x"], p["z"], np.sqrt(np.maximum(0, p["radius"]**2 - depth**2))])[cuts]


def bonds_of(frame):
    try:
        b = frame.bonds
        reach = 2.6 * frame.particles["radius"].max()  # what broke and drifted apart is no line any more
    except (AttributeError, ValueError):
        return np.zeros((0, 5))
    near = np.hypot(b["x1"] - b["x2"], b["y1"] - b["y2"]) < reach
    return np.column_stack([b["x1"], b["y1"], b["x2"], b["y2"], b["state"]])[near]


def scales(planes):
    """Colours of each field for all frames alike: dict of Scale; a few extreme cells, as in a first moment, do not count."""
    fast = max(float(np.nanmax(plane.speed)) for plane in planes)
    last = planes[len(planes) // 4:]  # the first pulse of pressure is none of the flow
    strong = max(float(np.nanpercentile(np.abs(p.pressure), 99.5)) if np.isfinite(p.pressure).any() else 0.0 for p in last)
    bars = {"speed": Scale(0.0, fast or 1.0, HOT), "pressure": Scale(-(strong or 1.0), strong or 1.0, TWO_SIDED)}
    seen = [p.viscosity for p in planes if p.viscosity is not None and np.isfinite(p.viscosity).any()]
    if seen:
        bars["viscosity"] = Scale(min(float(np.nanmin(v)) for v in seen), max(float(np.nanmax(v)) for v in seen), HOT)
    return bars


def places(plane, origin, size):
    """Particles and bonds in units of the drawing, up is less."""
    scale = UNITS / max(size)
    across = lambda x: np.round((x - origin[0]) * scale, 1).tolist()  # noqa: E731
    up = lambda y: np.round((size[1] - (y - origin[1])) * scale, 1).tolist()  # noqa: E731
    discs = [v for row in zip(across(plane.discs[:, 0]), up(plane.discs[:, 1]), np.round(plane.discs[:, 2] * scale, 1).tolist(),
                              strict=True) for v in row]
    bonds = [v for row in zip(across(plane.bonds[:, 0]), up(plane.bonds[:, 1]), across(plane.bonds[:, 2]), up(plane.bonds[:, 3]),
                              plane.bonds[:, 4].astype(int).tolist(), strict=True) for v in row]
    return discs, bonds


def thinned(planes):
    """Fewer frames where there are very many particles; the last one stays."""
    marks = sum(len(p.discs) + len(p.bonds) for p in planes)
    step = max(1, -(-marks // MOST_MARKS))
    return planes[::-1][::step][::-1]


def box_of(run):
    """Lengths of the box [m]."""
    return [run.parameters[f"box_{axis}"] for axis in "xyz" if f"box_{axis}" in run.parameters]


def read_planes(run):
    """A Plane of each frame that the page shows."""
    return [cut(frame, box_of(run)) for frame in chosen_frames(run.fields)]


def animation(run, planes):
    """HTML of the animation of a Run, which flow.js moves; nothing without planes."""
    if not planes:
        return ""
    p, size, planes = run.parameters, box_of(run), thinned(planes)
    first = run.fields[0].coordinates
    half = p["cell"] / 2
    flat, origin = [size[0], size[-1]], [first["x"][0] - half, first["z" if len(size) == 3 else "y"][0] - half]
    bars = scales(planes)
    entries = []
    for plane in planes:
        discs, bonds = places(plane, origin, flat)
        pictures = {kind: data_url(png(bar.indices(coarser(getattr(plane, kind)))[::-1], bar.palette()))
                    for kind, bar in bars.items() if getattr(plane, kind) is not None}
        entries.append({"t": f"{plane.time:.4g}", **pictures, "p": discs, "b": bonds})
    where = "" if len(size) == 2 else f"the plane y = {float(np.median(first['y'])):.3g} m, and the particles that it cuts · "
    return frame_of(entries, flat, bars, where)


def frame_of(entries, flat, bars, where):
    """The pictures' place in the page, with slider, buttons and colours. bars: scale of each field."""
    ratio, last = flat[0] / flat[1], len(entries) - 1
    width, height = (UNITS * side / max(flat) for side in flat)
    shown = 560 * min(ratio, 1.9)  # pixels wide
    bonds = '; bonds: <span style="color:#2f8f4e">intact</span>, broken by <span style="color:#d62728">tension</span>, by ' \
            '<span style="color:#1f77b4">shear</span>' if any(e["b"] for e in entries) else ""
    buttons = " ".join(f'<button data-kind="{kind}">{kind}</button>' for kind in bars)
    colours = "".join(f'<div data-bar="{kind}"{"" if kind == "speed" else " hidden"}>{bar.bar(LABELS[kind])}</div>'
                      for kind, bar in bars.items())
    return (f'<figure class="field" style="width:min(100%,{max(320, shown):.0f}px)">'
            f'<div id="flow" style="position:relative;aspect-ratio:{ratio:.4f};width:min(100%,{shown:.0f}px)">'
            f'<img alt="the fluid" src="{entries[-1]["speed"]}" style="position:absolute;inset:0;height:100%">'
            f'<svg viewBox="0 0 {width:.0f} {height:.0f}" preserveAspectRatio="none" '
            'style="position:absolute;inset:0;width:100%;height:100%"></svg></div>'
            f'<input id="flow-slide" type="range" min="0" max="{last}" value="{last}" aria-label="time">'
            f'<p style="margin:4px 0"><button id="flow-play">play</button> {buttons} '
            '<span id="flow-time" class="soft"></span></p>'
            f"{colours}"
            f"<figcaption>{where}{flat[0]:.4g} m wide, {flat[1]:.4g} m high{bonds}; grey: no fluid</figcaption></figure>"
            f'<script id="flow-data" type="application/json">{json.dumps({"frames": entries})}</script>')
