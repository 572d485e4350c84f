"""Drivers with a UART, on an emulated line."""
