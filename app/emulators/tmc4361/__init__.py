"""An emulated TMC4361: SPI on one side, motor, encoder and switches on the other."""
