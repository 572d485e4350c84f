"""The study of how much torque a motor has at each speed."""
