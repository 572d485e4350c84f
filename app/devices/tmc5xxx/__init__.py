"""The driver of a TMC5xxx, in layers of one subject each: the driver itself is `driver.Tmc5xxx`.

rows, ramp  what the chips have in common, by what it is; the ramp as far as anybody knows it
chip        the chip behind the link: who answers, what is kept in mind of it
events      GSTAT and RAMP_STAT read so that nothing is lost, as a timeline
moves       positioning and rotation, and what is expected of them
stops       stops; setting the position
writes      what a write by hand does to a motion
polling     the axes now, and why they came to rest
encoder     what sets an encoder right whose resolution is set wrong
samples     telemetry
raw         single datagrams
tables      microstep tables and profile
"""
