"""Thin command: see bplbm/checks/documents.py; with --commands bplbm/checks/commands.py, which needs the programs built."""

import sys

from bplbm.checks import commands, documents

sys.exit(commands.main() if sys.argv[1:] == ["--commands"] else documents.main())
