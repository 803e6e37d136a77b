"""The rim of the vehicle: sockets, serial lines, wall time, fleets, and the files that outlive a run."""
