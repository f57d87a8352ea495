"""tools/run after it has built; `python3 tools/launch.py SCENE` runs a scene without building."""

from bplbm.run import command_line

command_line()
