"""Registers of the stepper drivers without a ramp generator: TMC2130, TMC2209, TMC2240, TMC2660.

Many rows are those of the TMC5xxx, which have the same driver inside, and are taken from there.
"""
