"""BPLBM's tools, and what a notebook or a scene's plot.py needs to read and draw a run.

    import bplbm
    run = bplbm.Run("out/settling_disc")

Names are taken from their modules when they are first asked for, so that `import bplbm` needs neither h5py nor matplotlib.
"""

import importlib

_RESULTS = ("Run", "fall_in_layers", "quantity", "read_table", "result", "studies", "write_table")
_READING = ("Field", "Frame", "Table")
_PICTURES = ("UNITS", "animate", "drag_results", "draw_bonds", "draw_breaks", "draw_errors", "draw_slice", "draw_snapshots", "draw_speed",
             "draw_viscosity", "read_breaks")
_MODULES = {**dict.fromkeys(_RESULTS, "results"), **dict.fromkeys(_READING, "reading"), **dict.fromkeys(_PICTURES, "pictures")}

__all__ = [*_MODULES]


def __getattr__(name):
    if name not in _MODULES:
        raise AttributeError(f"bplbm has no '{name}'; it has {', '.join(__all__)}")
    return getattr(importlib.import_module(f"bplbm.{_MODULES[name]}"), name)


def __dir__():
    return [*globals(), *__all__]
