"""Line charts as SVG text: small, sharp at any size, and drawn in milliseconds."""

import html
import math
from dataclasses import dataclass

import numpy as np

COLORS = ("#1f6fb4", "#d1602b", "#2f8f4e", "#7a5bb0", "#b03a48", "#6b7280", "#b8860b", "#0f8b8d")
MOST_POINTS = 500  # of a line; what a screen can show
LEFT, RIGHT, TOP, BOTTOM = 80, 22, 12, 40
LETTER = 6.2  # width of one, about
LINE = 13  # height of one
NEARLY = 1e-3  # of the distance of two ticks: an end that close to one has it
PLAIN_DIGITS = 6  # of numbers that are written without an exponent


@dataclass(frozen=True)
class Line:
    """A series of a chart."""

    name: str
    x: np.ndarray
    y: np.ndarray
    marked: bool = False  # a dot at each point


def ticks(low, high, wanted=5):
    """Round numbers within a range."""
    if not high > low:
        return [low]
    raw = (high - low) / wanted
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(power * f for f in (1, 2, 2.5, 5, 10) if power * f >= raw)
    first = math.ceil(low / step - NEARLY)
    return [round(i * step, 12 - math.floor(math.log10(step))) for i in range(first, math.floor(high / step + NEARLY) + 1)]


def tick_texts(values):
    """Their texts, with as many digits as tell them apart."""
    largest = max(map(abs, values), default=0.0)
    step = values[1] - values[0] if len(values) > 1 else largest
    digits = PLAIN_DIGITS if not step else max(PLAIN_DIGITS, min(12, 2 + math.ceil(math.log10(max(1.0, largest / step)))))
    return [f"{value:.{digits}g}" for value in values]


def thinned(x, y):
    """At most MOST_POINTS, of which none is a peak left out: the smallest and the largest of each piece stay, and both ends."""
    if len(x) <= MOST_POINTS:
        return x, y
    kept = {0, len(x) - 1}
    for piece in np.array_split(np.arange(len(x)), MOST_POINTS // 2 - 1):
        finite = piece[np.isfinite(y[piece])]
        kept |= {finite[y[finite].argmin()], finite[y[finite].argmax()]} if len(finite) else {piece[0]}
    chosen = np.array(sorted(kept))
    return x[chosen], y[chosen]


def span(values):
    """Range of all finite values, a little wider where they are all alike."""
    finite = np.concatenate([v[np.isfinite(v)] for v in values]) if values else np.zeros(0)
    if not len(finite):
        return 0.0, 1.0
    low, high = float(finite.min()), float(finite.max())
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        half = 0.05 * abs(high) or 1.0
        return low - half, high + half
    return low, high


def pieces(x, y):
    """Runs of neighbouring finite points."""
    good = np.isfinite(x) & np.isfinite(y)
    edges = np.flatnonzero(np.diff(good.astype(int))) + 1
    split = zip(np.split(x, edges), np.split(y, edges), strict=True)
    return [(a, b) for a, b in split if len(a) and np.isfinite(a[0]) and np.isfinite(b[0])]


def label_lines(text, length):
    """A label in one line, or in two where it is longer than its axis, parted at the blank that is nearest to its middle."""
    blanks = [i for i, letter in enumerate(text) if letter == " "]
    if LETTER * len(text) <= length or not blanks:
        return [text]
    at = min(blanks, key=lambda i: abs(2 * i - len(text)))
    return [text[:at], text[at + 1:]]


def legend_places(names, width):
    """Places of entries in rows that hold them, and the number of rows."""
    places, x, row = [], 0.0, 0
    for name in names:
        needs = 30 + LETTER * len(name)
        if x and x + needs > width:
            x, row = 0.0, row + 1
        places.append((x, row))
        x += needs
    return places, row + 1 if any(names) else 0


class Axes:
    """Values to places on the paper."""

    def __init__(self, xs, ys, area):
        self.x, self.y, self.area = span(xs), span(ys), area
        margin = 0.04 * (self.y[1] - self.y[0])
        self.y = self.y[0] - margin, self.y[1] + margin

    def place(self, x, y):
        left, top, right, bottom = self.area
        return (left + (x - self.x[0]) / (self.x[1] - self.x[0]) * (right - left),
                bottom - (y - self.y[0]) / (self.y[1] - self.y[0]) * (bottom - top))

    def grid(self):
        """Lines and numbers at round values."""
        left, top, right, bottom = self.area
        xs, ys = ticks(*self.x), ticks(*self.y)
        for tick, text in zip(xs, tick_texts(xs), strict=True):
            x, _ = self.place(tick, 0.0)
            yield f'<path class="grid" d="M{x:.1f} {top}V{bottom}"/>'
            yield f'<text x="{x:.1f}" y="{bottom + 14}" class="middle">{text}</text>'
        for tick, text in zip(ys, tick_texts(ys), strict=True):
            _, y = self.place(0.0, tick)
            yield f'<path class="grid" d="M{left} {y:.1f}H{right}"/>'
            yield f'<text x="{left - 5}" y="{y + 3.5:.1f}" class="end">{text}</text>'

    def curve(self, line, x, y, color):
        """A line through its finite points, with dots if it is marked."""
        path = "".join("M" + "L".join("{:.1f} {:.1f}".format(*self.place(a, b)) for a, b in zip(*piece, strict=True))
                       for piece in pieces(x, y))
        yield f'<path d="{path}" fill="none" stroke="{color}" stroke-width="1.6"/>'
        for a, b in zip(x, y, strict=True) if line.marked else ():
            if np.isfinite(a) and np.isfinite(b):
                yield '<circle cx="{:.1f}" cy="{:.1f}" r="3" fill="{}"/>'.format(*self.place(a, b), color)


def line_chart(lines, x_label, y_label, width=470, height=250):
    """SVG of lines on common axes."""
    data = [(line, *thinned(np.asarray(line.x, float), np.asarray(line.y, float))) for line in lines if len(line.x)]
    right, bottom = width - RIGHT, height - BOTTOM
    entries, rows = legend_places([line.name for line, *_ in data], right - LEFT)
    top = TOP + 15 * rows
    axes = Axes([x for _, x, _ in data], [y for *_, y in data], (LEFT, top, right, bottom))
    out = [f'<svg class="chart" viewBox="0 0 {width} {height}" role="img" aria-label="{html.escape(y_label)} against '
           f'{html.escape(x_label)}">', *axes.grid()]
    for i, ((line, x, y), (across, row)) in enumerate(zip(data, entries, strict=True)):
        color, at = COLORS[i % len(COLORS)], (LEFT + across, TOP + 15 * row)
        out += axes.curve(line, x, y, color)
        if line.name:
            out.append(f'<path d="M{at[0]:.0f} {at[1] - 4}h14" stroke="{color}" stroke-width="2"/>'
                       f'<text x="{at[0] + 18:.0f}" y="{at[1]}">{html.escape(line.name)}</text>')
    out += [f'<path class="axis" d="M{LEFT} {top}V{bottom}H{right}"/>',
            f'<text x="{(LEFT + right) / 2:.0f}" y="{height - 8}" class="middle">{html.escape(x_label)}</text>',
            *(f'<text transform="translate({10 + LINE * i} {(top + bottom) / 2:.0f}) rotate(-90)" class="middle">{html.escape(part)}</text>'
              for i, part in enumerate(label_lines(y_label, bottom - top)))]
    return "".join(out) + "</svg>"
