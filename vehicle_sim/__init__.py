"""A multicopter in software: hover dynamics, a Kalman estimator and a MAVLink autopilot in front of them."""
