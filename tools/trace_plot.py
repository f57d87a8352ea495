"""Thin command of `trace plot`: see bplbm/trace_plot.py."""

import sys

from bplbm.trace_plot import main

sys.exit(main(sys.argv[1], sys.argv[2], int(sys.argv[3])))
