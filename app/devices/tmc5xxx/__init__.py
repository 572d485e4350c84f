"""The driver of a TMC5xxx, of parts that `family.compose` puts together.

rows, ramp, flags     what the chips have in common, by what it is; the ramp and the event flags as far as anybody knows
memory, decoded_registers  what the registers hold, and what that means; nothing is asked of the chip
predictions, motions  what is expected of the axes, and what ended their motions
events, reader        GSTAT and RAMP_STAT read so that nothing is lost, as a timeline
preparation, moves    positioning and rotation
standstill, stops     axes that are kept where they are, and stops
position, clearing    calling a place by another number; taking notice of flags
writes, written_motion  what a write by hand does, and what is expected after it
monitor, signs        the axes now, and why they came to rest
counter, encoder      the position counter; what sets an encoder right whose resolution is set wrong
telemetry, raw, mslut channels, single datagrams, microstep tables
configuration         what registers mean in a profile
chip_identity         who answers
"""
