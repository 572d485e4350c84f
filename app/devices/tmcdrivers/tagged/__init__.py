"""Drivers of 20-bit datagrams (TMC26x), of which nothing is read but a status: the parts that differ for that."""
