"""``python -m mission``."""

import sys

from mission.cli import main

if __name__ == "__main__":
    sys.exit(main())
