"""The TMC428's SPI driver chain: signals, words of its RAM, frequencies."""
