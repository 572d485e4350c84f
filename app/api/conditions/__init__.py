"""How every axis stands: one state with its cause, by socket and by REST."""
