"""The driver of a TMC22xx alone, of parts that `family.compose` puts together.

A motor behind it is moved by STEP and DIR from outside, or at a velocity of its own (VACTUAL), which jumps. Nothing
counts its position but the place in the microstep table.

rows, memory      the registers by what they are, and what they hold; nothing is asked of the chip
resets            GSTAT.reset, seen and kept for its user
reader, monitor   one reading of an axis, and what it says
motion, writes    rotation and stops; what a write by hand does
signs, limits     what is wrong, and what registers mean for soft limits
"""
