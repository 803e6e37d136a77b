"""The MAVLink side of a flight: frames, messages, the offboard session and the transports."""
