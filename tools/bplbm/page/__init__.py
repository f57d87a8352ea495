"""Pages of one self-contained file: of a run, and of a sweep. They need numpy and h5py, no plot.py and no matplotlib."""
