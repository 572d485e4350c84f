"""The TMC428 family: ramps by pmul and pdiv, datagrams of 32 bits."""
