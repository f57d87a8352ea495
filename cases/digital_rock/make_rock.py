"""Writes rock.h5, an image as a scanner would give of touching spheres in a cubic array: grey levels, 0 in the pores and
255 in the grains, between where a voxel holds both.

    make_rock.py [VOXELS]   # along each side, 64
"""

import pathlib
import sys

import h5py
import numpy as np

CENTRE = np.array([0.511, 0.5205, 0.493])  # of the sphere, over the side: nothing is symmetric about the voxels
FINER = 6                                  # places along each side of a voxel


def rock(voxels):
    """Grey levels [z][y][x] of one periodic cell of the array."""
    places = (np.arange(voxels * FINER) + 0.5) / (voxels * FINER)
    squares = [np.minimum(abs(places - c), 1 - abs(places - c))**2 for c in CENTRE]
    grey = np.empty((voxels,) * 3, dtype=np.uint8)
    in_layer = squares[1][:, None] + squares[0][None, :]
    for z in range(voxels):
        inside = sum((in_layer + z2 < 0.25).astype(float) for z2 in squares[2][FINER * z:FINER * (z + 1)])
        parts = inside.reshape(voxels, FINER, voxels, FINER).sum(axis=(1, 3)) / FINER**3
        grey[z] = np.round(255 * parts)
    return grey


def main():
    image = rock(int(sys.argv[1]) if len(sys.argv) > 1 else 64)
    path = pathlib.Path(__file__).with_name("rock.h5")
    with h5py.File(path, "w", track_order=True) as out:
        out.create_dataset("grey", data=image, compression="gzip", compression_opts=9, shuffle=True)
    print(f"{path.name}: {image.shape[0]}³ voxels, porosity {1 - image.mean() / 255:.4f}")


if __name__ == "__main__":
    main()
