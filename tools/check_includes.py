"""Thin command: see bplbm/checks/includes.py."""

import sys

from bplbm.checks.includes import main

sys.exit(main())
