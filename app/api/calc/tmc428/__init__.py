"""Calculators of the TMC428, TMC429 and TMC4210."""
