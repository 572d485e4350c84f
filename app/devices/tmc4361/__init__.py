"""The driver of a TMC4361, composed of parts of one subject each: `family.compose` is the list.

memory           the shadow of its registers: as last seen, and what cannot be read as it was written
cruise           the ramp as its user wants it, while commands write something else over it
expected_motion  the ramp expected of the motion under way, and the watch that tells how it ended
events           EVENTS read so that nothing is lost, as a timeline
monitor          the axis now, the poller, and why the motor came to rest
departure        what every motion has in common: what is read before, and the one chain that sets off
moves, rotation  positioning, and turning on and on
stops, position  stops; setting the position
motion           moves, rotation and stops as one capability
writes           what is known of registers, what a write by hand does to a motion, and what is expected after it
registers, raw   registers by name; single datagrams
counter          the position counter, and resets
encoder          what sets an encoder right whose resolution is set wrong
telemetry        channels
tables           microstep table
configuration    what registers mean as a configuration
chip_identity    who answers
"""
