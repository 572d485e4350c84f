"""Emulated TMC428 and TMC4210: ramps, driver chain, sequencer, step and direction."""
