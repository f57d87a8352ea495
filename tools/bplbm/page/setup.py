"""The set-up of a scene as a drawing: box, sides, boundary conditions, obstacles, and particles where they begin."""

import base64
import html
import io

import numpy as np

from bplbm import shapes
from bplbm.reading import read_table
from bplbm.scene_words import COLOR, drive_text, motion_text, side_line, words

# Colours of matplotlib by name, light enough for a dark page and dark enough for a white one.
LEGIBLE = {"tab:blue": "#2f86c8", "tab:green": "#2ca02c", "tab:orange": "#e8760c", "tab:purple": "#9a70c4", "tab:gray": "#7f7f7f"}
MOST_DISCS = 4000
MOST_TRIANGLES = 6000
WIDTH, ROOM = 360, 46  # of the drawing; beside it for words


def dimensions(tables):
    return len(tables["box"]["size"])


def flat_box(tables):
    """Across and up [m]: x and y, in three dimensions x and z."""
    size = tables["box"]["size"]
    return [size[0], size[-1]]


def flat_origin(tables):
    """Lower left corner of the drawing [m]: x and y of the box's origin, in three dimensions x and z."""
    origin = tables["box"].get("origin", [0.0] * dimensions(tables))
    return [origin[0], origin[-1]]


def drawn_sides(tables):
    """Key of the box and names of the two sides of each axis that is drawn."""
    return {"sides_x": ("left", "right"),
            **({"sides_y": ("bottom", "top")} if dimensions(tables) == 2 else {"sides_z": ("back", "front")})}


def on_paper(side):
    """The side of the drawing on which a side of the box lies; none for the two that face the reader."""
    return {"left": "left", "right": "right", "bottom": "bottom", "top": "top", "back": "bottom", "front": "top"}[side]


def stretch(boundary, tables):
    """Where a boundary condition begins and ends [m], from the beginning of its side of the drawing on."""
    vertical = boundary["side"] in ("left", "right")
    length, begin = (corner[1 if vertical else 0] for corner in (flat_box(tables), flat_origin(tables)))
    low, high = boundary.get("from", begin), boundary.get("to", begin + length)
    if isinstance(low, list):  # along the side's two axes: y, z of left and right; x, y of back and front
        low = low[1 if vertical else 0]
    if isinstance(high, list):
        high = high[1 if vertical else 0]
    return low - begin, high - begin


class Drawing:
    """Metres to the paper, and SVG parts."""

    def __init__(self, tables):
        self.tables, self.box = tables, flat_box(tables)
        self.scale = WIDTH / max(self.box[0], 0.75 * self.box[1])
        self.width, self.height = (side * self.scale for side in self.box)
        self.parts = []
        self.origin = flat_origin(tables)

    def at(self, x, y):
        return ROOM + x * self.scale, ROOM + (self.box[1] - y) * self.scale

    def place(self, point):
        """Of a point of the scene, which counts from the box's origin."""
        return self.at(point[0] - self.origin[0], point[-1] - self.origin[1])

    def line(self, xs, ys, style):
        (x0, y0), (x1, y1) = self.at(xs[0], ys[0]), self.at(xs[1], ys[1])
        self.parts.append(f'<path d="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}" {style}/>')

    def sides(self):
        for key, names in drawn_sides(self.tables).items():
            periodic = self.tables["box"].get(key, "wall") == "periodic"
            style = 'stroke="#888" stroke-width="1.2" stroke-dasharray="5 4"' if periodic else \
                'stroke="currentColor" stroke-width="3" stroke-linecap="square"'
            for name in map(on_paper, names):
                self.line(*side_line(name, self.box, 0, self.box[1] if name in ("left", "right") else self.box[0]), style)

    def boundaries(self):
        for b in self.tables.get("boundary", []):
            if b["side"] in ("bottom", "top") and dimensions(self.tables) == 3:
                continue  # they face the reader
            side, (low, high) = on_paper(b["side"]), stretch(b, self.tables)
            color = LEGIBLE[COLOR.get(b["kind"], "tab:gray")]
            xs, ys = side_line(side, self.box, low, high)
            self.line(xs, ys, f'stroke="{color}" stroke-width="6"')
            x, y = self.at(sum(xs) / 2, sum(ys) / 2)
            dx, dy, turn = {"left": (-14, 0, -90), "right": (18, 0, -90), "bottom": (0, 20, 0), "top": (0, -10, 0)}[side]
            self.parts.append(f'<text transform="translate({x + dx:.1f} {y + dy:.1f}) rotate({turn})" class="middle" '
                              f'style="fill:{color}">{html.escape(words(b))}</text>')

    def image(self, o, folder):
        """An image as it is, in three dimensions the most solid voxel along y."""
        parts = shapes.solid_fraction(o, folder)
        x0, x1, *_, z0, z1 = shapes.image_extent(o, parts, self.tables["box"].get("origin", [0.0] * dimensions(self.tables)))
        seen = parts if parts.ndim == 2 else parts.max(axis=1)
        pixels = np.zeros((*seen.shape, 4))
        pixels[..., :3], pixels[..., 3] = 0.6, seen[::-1]
        import matplotlib.image  # half of what a page takes, and few scenes have images
        out = io.BytesIO()
        matplotlib.image.imsave(out, pixels, format="png")
        (left, top), (right, bottom) = self.place((x0, z1)), self.place((x1, z0))
        self.parts.append(f'<image x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" height="{bottom - top:.1f}" '
                          'preserveAspectRatio="none" style="image-rendering:pixelated" '
                          f'href="data:image/png;base64,{base64.b64encode(out.getvalue()).decode()}"/>')

    def mesh(self, o, folder):
        """The triangles of a mesh that face the reader, seen along y; pale where the middle of the box cuts it, with the lines
        of the cut, which show what is hollow."""
        corners = shapes.placed_mesh(o, folder)
        size, origin = self.tables["box"]["size"], self.tables["box"].get("origin", [0.0] * 3)
        cut = shapes.section(corners, origin[1] + 0.5 * size[1])[:MOST_TRIANGLES]
        outline = "".join("M" + "L".join("{:.1f} {:.1f}".format(*self.place(corner)) for corner in t) + "Z"
                          for t in shapes.facing(corners)[:MOST_TRIANGLES])
        self.parts.append(f'<path d="{outline}" fill="#999" stroke="#555" stroke-width=".3" '
                          f'fill-opacity="{0.25 if len(cut) else 0.8}" stroke-opacity="{0.3 if len(cut) else 1}"/>')
        lines = "".join("M" + "L".join("{:.1f} {:.1f}".format(*self.place(end)) for end in line) for line in cut)
        width = max(1.5, o.get("thickness", 0.0) * self.scale)
        if lines:
            self.parts.append(f'<path d="{lines}" stroke="#444" stroke-width="{width:.1f}" stroke-linecap="round"/>')

    def motion(self, o, folder):
        """How an obstacle moves: in its middle, of a hollow one above it."""
        text = motion_text(o, dimensions(self.tables))
        if not text:
            return
        low, high = shapes.extent(o, folder)
        origin = np.array(self.tables["box"].get("origin", np.zeros(len(low))))
        low, high = (np.clip(corner, origin, origin + self.tables["box"]["size"]) for corner in (low, high))
        x, y = self.place(np.append(0.5 * (low + high)[:-1], high[-1] if o.get("hollow") else 0.5 * (low + high)[-1]))
        self.parts.append(f'<text x="{x:.1f}" y="{y - 4 if o.get("hollow") else y + 4:.1f}" class="middle">{html.escape(text)}</text>')

    def obstacles(self, folder):
        """Cut at the sides of the box; the words on them are not."""
        self.parts.append(f'<clipPath id="setup-box"><rect x="{ROOM}" y="{ROOM}" width="{self.width:.1f}" height="{self.height:.1f}"/>'
                          '</clipPath><g clip-path="url(#setup-box)">')
        for o in self.tables.get("obstacle", []):
            if "image" in o:
                self.image(o, folder)
            elif "mesh" in o:
                self.mesh(o, folder)
            elif "diameter" in o and "from" in o:  # a cylinder; one that points at the reader is a dot
                (x0, y0), (x1, y1) = self.place(o["from"]), self.place(o["to"])
                self.parts.append(f'<path d="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}" stroke="#999" stroke-linecap="'
                                  f'{"round" if o["from"][::2] == o["to"][::2] else "butt"}" '
                                  f'stroke-opacity=".8" stroke-width="{o["diameter"] * self.scale:.1f}"/>')
            elif "diameter" in o:
                x, y = self.place(o["centre"])
                fill = "none" if o.get("hollow") else "#999"
                self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{o["diameter"] / 2 * self.scale:.1f}" fill="{fill}" '
                                  'stroke="#555"/>')
            elif "from" in o and "to" in o:
                (x0, y1), (x1, y0) = self.place(o["from"]), self.place(o["to"])
                self.parts.append(f'<rect x="{x0:.1f}" y="{y0:.1f}" width="{x1 - x0:.1f}" height="{y1 - y0:.1f}" fill="#999" '
                                  'stroke="#555"/>')
        self.parts.append("</g>")
        for o in self.tables.get("obstacle", []):
            self.motion(o, folder)

    def discs(self, discs, fill="#f4dfb8"):
        for x, y, radius in discs[:MOST_DISCS]:
            cx, cy = self.place((x, y))
            self.parts.append(f'<circle cx="{cx:.1f}" cy="{cy:.1f}" r="{radius * self.scale:.1f}" fill="{fill}" '
                              'stroke="#6b5d43" '
                              'stroke-width=".6"/>')

    def lengths(self):
        x, y = ROOM + self.width / 2, ROOM + self.height + 38
        self.parts.append(f'<text x="{x:.0f}" y="{y:.0f}" class="middle">x: {self.box[0]:g} m</text>')
        up = "y" if dimensions(self.tables) == 2 else "z"
        self.parts.append(f'<text transform="translate({ROOM + self.width + 36:.0f} {ROOM + self.height / 2:.0f}) rotate(-90)" '
                          f'class="middle">{up}: {self.box[1]:g} m</text>')

    def svg(self):
        width, height = self.width + 2 * ROOM, self.height + 2 * ROOM
        return (f'<svg viewBox="0 0 {width:.0f} {height:.0f}" role="img" aria-label="set-up" '
                f'style="width:{width:.0f}px;max-width:100%;font:11px system-ui,sans-serif">'
                f'<rect x="{ROOM}" y="{ROOM}" width="{self.width:.1f}" height="{self.height:.1f}" fill="#4a90d9" fill-opacity=".10"/>{"".join(self.parts)}</svg>')


def first_discs(run, tables):
    """Places and radii [m] of the particles in the first frame, seen along y in three dimensions; else of the scene's list."""
    frames = run.fields
    if len(frames):
        try:
            p = frames[0].particles
            discs = np.column_stack([p["x"], p["y" if dimensions(tables) == 2 else "z"], p["radius"]])
            return discs[discs[:, 2] > 0].tolist()  # the carrier of a clump has no radius
        except AttributeError:
            pass
    particles = tables.get("particles", {})
    radius = float(np.max(particles.get("diameter", 0.0))) / 2
    return [(place[0], place[-1], radius) for place in particles.get("start", [])]


def grains(tables, folder):
    """Places and radii [m] of the grains at rest that a table beside the scene lists."""
    if "grains" not in tables:
        return []
    table = read_table(folder / tables["grains"]["file"])
    return np.column_stack([table["x"], table["z" if "z" in table else "y"], table["diameter"] / 2]).tolist()


def setup(run, tables, folder):
    """HTML of the drawing and what drives the flow. folder: of the scene."""
    drawing = Drawing(tables)
    drawing.obstacles(folder)
    drawing.discs(grains(tables, folder), "#999")
    drawing.discs(first_discs(run, tables))
    drawing.sides()
    drawing.boundaries()
    drawing.lengths()
    seen = "" if dimensions(tables) == 2 else "Seen along y, meshes with their section in the middle of the box. "
    text = html.escape(drive_text(tables)).replace("\n", "<br>")
    return (f'<figure>{drawing.svg()}<figcaption>{seen}{text}<br>thick: wall · dashed: periodic · coloured: boundary condition'
            "</figcaption></figure>")
