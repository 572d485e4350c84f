"""Connections and the devices behind them, emulated ones with their plant."""
