"""How the server is: liveness, details, metrics."""
