"""TMC5xxx on an emulated UART, and their control port."""
