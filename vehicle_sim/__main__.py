"""`python -m vehicle_sim` is the program `vehicle-sim`."""

import sys

from vehicle_sim.cli import main

if __name__ == "__main__":
    sys.exit(main())
