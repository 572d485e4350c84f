"""Emulated modules behind a serial line: bytes in, bytes out, each byte at its time on the wire.

`line.Line` is the wire and knows no file descriptor; `server.LineServer` puts one behind a pseudo terminal
or a TCP port, in a process of its own.
"""
