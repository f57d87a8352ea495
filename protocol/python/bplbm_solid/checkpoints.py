# SPDX-License-Identifier: MIT
"""The solid's part of a checkpoint: PREFIX.INTERVAL.solid, whole or not at all; the two before it stay."""

import pathlib
from typing import Dict, Tuple

import numpy as np

from .errors import BAD_INPUT, SolidError
from .records import STATE

EARLIER = 2  # parts that stay beside the last one


def write(prefix: pathlib.Path, interval: int, arrays: Dict[str, np.ndarray]) -> None:
    whole = prefix.with_name(f"{prefix.name}.{interval}.solid")
    part = whole.with_name(whole.name + ".part")
    try:
        with part.open("wb") as file:
            np.savez(file, **arrays)
        part.rename(whole)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise SolidError(f"the checkpoint {whole} cannot be written ({error}); is the disk full?") from error
    _remove_others(prefix, interval)


def _remove_others(prefix: pathlib.Path, interval: int) -> None:
    parts = {}
    for path in prefix.parent.glob(prefix.name + ".*.solid"):
        number = path.name[len(prefix.name) + 1:-len(".solid")]
        if number.isdigit():
            parts[int(number)] = path
    stay = sorted(k for k in parts if k <= interval)[-1 - EARLIER:]
    for k in parts.keys() - stay:
        parts[k].unlink(missing_ok=True)


def read(path: str) -> Tuple[np.ndarray, Dict[str, np.ndarray]]:
    """@return  STATE array and what else was kept"""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        states = arrays.pop("states")
    except (OSError, ValueError, KeyError, EOFError) as error:
        raise SolidError(f"{path} is no checkpoint of this engine: {error}", BAD_INPUT) from error
    except Exception as error:  # zipfile.BadZipFile, and what a damaged archive brings up beside it
        raise SolidError(f"{path} is damaged: {type(error).__name__}: {error}", BAD_INPUT) from error
    if states.dtype != STATE:
        raise SolidError(f"{path} is no checkpoint of this engine: its states are {states.dtype}", BAD_INPUT)
    return states, arrays
