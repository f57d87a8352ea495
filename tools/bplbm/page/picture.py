"""Pictures of fields as small PNG files with a palette, written with numpy and zlib alone."""

import base64
import math
import struct
import zlib
from dataclasses import dataclass

import numpy as np

HOT = ("#000004", "#1c1044", "#4f127b", "#812581", "#b5367a", "#e55064", "#fb8761", "#fec287", "#fcfdbf")
TWO_SIDED = ("#2a5caa", "#7aa3d6", "#cddff0", "#f6f6f6", "#f6d5c4", "#e08e6d", "#b2342c")
NOTHING = 255  # index of a cell without a value
GREY = (150, 150, 150)
MOST_CELLS, MOST_FRAMES, MOST_MARKS = 320, 24, 60000  # along a side; of an animation; particles of all its frames


@dataclass(frozen=True)
class Scale:
    """Colours of a quantity between two values."""

    low: float
    high: float
    stops: tuple

    def palette(self):
        """RGB of the indices 0 … 254, and of NOTHING."""
        rgb = np.array([[int(stop[i:i + 2], 16) for i in (1, 3, 5)] for stop in self.stops], float)
        place = np.linspace(0, len(rgb) - 1, NOTHING)
        colors = np.column_stack([np.interp(place, np.arange(len(rgb)), rgb[:, k]) for k in range(3)])
        return np.vstack([colors.round(), GREY]).astype(np.uint8)

    def indices(self, values):
        width = self.high - self.low or 1.0
        scaled = np.clip((values - self.low) / width, 0, 1) * (NOTHING - 1)
        return np.where(np.isfinite(values), np.nan_to_num(scaled), NOTHING).astype(np.uint8)

    def bar(self, label):
        """The colours with their ends, as HTML."""
        return (f'<div class="soft" style="display:flex;gap:8px;align-items:center;font-size:13px"><span>{self.low:.3g}</span>'
                f'<span style="flex:1;height:10px;border-radius:3px;background:linear-gradient(90deg,{",".join(self.stops)})">'
                f"</span><span>{self.high:.3g}</span><span>{label}</span></div>")


def png(indices, palette):
    """Bytes of a PNG of palette indices, the first row on top."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width = indices.shape
    rows = np.zeros((height, width + 1), np.uint8)  # each row begins with its filter: none
    rows[:, 1:] = indices
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0))
            + chunk(b"PLTE", palette.tobytes()) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)) + chunk(b"IEND", b""))


def data_url(data, kind="image/png"):
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def coarser(values):
    """Every n-th cell, so that no side has more than MOST_CELLS."""
    step = max(1, math.ceil(max(values.shape[:2]) / MOST_CELLS))
    return values[step // 2::step, step // 2::step]


def chosen_frames(frames):
    """At most MOST_FRAMES of them, evenly spread, the first and the last among them."""
    if not len(frames):
        return []
    count = min(len(frames), MOST_FRAMES)
    numbers = np.unique(np.linspace(0, len(frames) - 1, count).round().astype(int))
    return [frames[int(i)] for i in numbers]
