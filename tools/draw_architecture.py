"""Thin command: see bplbm/checks/architecture.py."""

import sys

from bplbm.checks.architecture import main

sys.exit(main())
