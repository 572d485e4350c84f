"""`stepscope emulate`: one emulated chip, module or line behind a socket or a terminal, and its control port."""
