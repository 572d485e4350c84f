"""The steps, each named by its number. One that was released stays as it is: files out there have it behind them."""
