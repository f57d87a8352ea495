"""The former name of bplbm, for a scene's plot.py that still says `from pictures import …`."""

from bplbm.pictures import *  # noqa: F403
from bplbm.results import *  # noqa: F403
