#!/bin/sh
# bplbm COMMAND …: runs scenes from any folder. bplbm --help lists the commands.
prefix=$(dirname "$(dirname "$(readlink -f "$0")")")
export PYTHONPATH="$prefix/share/bplbm/tools${PYTHONPATH:+:$PYTHONPATH}" PYTHONDONTWRITEBYTECODE=1 MPLBACKEND=Agg
exec /usr/bin/python3 -P -m bplbm.command "$@"
