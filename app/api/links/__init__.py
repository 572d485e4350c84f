"""Serial ports, wires, their frames and incidents; what is found on them."""
