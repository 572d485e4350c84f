"""Closed loop operation: calibration, step response, disturbance."""
