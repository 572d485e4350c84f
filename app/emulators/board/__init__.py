"""An emulated Landungsbrücke: nine-byte TMCL frames on one side, the SPI of a chip on the other.

What it answers, and what it does to the chip unasked, is what Trinamic's published firmware does
(analogdevicesinc/TMC-EvalSystem: tmc/TMCL.c, tmc/BoardAssignment.c, boards/TMC4361A_eval.c; register access of
analogdevicesinc/TMC-API: tmc/ic/TMC4361A). Said in our words, and only as far as it can be seen from outside:
bootloader, RAM debugger, WLAN and the driver board's own commands are refused.
"""
