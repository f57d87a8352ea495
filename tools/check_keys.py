"""Thin command: see bplbm/checks/keys.py."""

import sys

from bplbm.checks.keys import main

sys.exit(main())
