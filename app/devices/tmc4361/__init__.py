"""The driver of a TMC4361, in layers of one subject each: the driver itself is `driver.Tmc4361`.

chip       the chip behind the link: who answers, what is kept in mind of it
events     EVENTS read so that nothing is lost, as a timeline
moves      positioning and rotation, and what is expected of them
stops      stops; setting the position
writes     what a write by hand does to a motion
polling    the axis now, and why it came to rest
encoder    what sets an encoder right whose resolution is set wrong
samples    telemetry
raw        single datagrams
tables     microstep table and profile
"""
