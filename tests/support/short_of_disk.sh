#!/bin/sh
# short_of_disk.sh KILOBYTES PROGRAM ARGUMENTS…: the program with no file of it allowed to grow beyond that, as on a disk
# that is full.
trap '' XFSZ
ulimit -f $(($1 * 2))
shift
exec "$@"
