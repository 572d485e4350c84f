"""What drivers are made of, whichever family: identity, state, register access, prediction, polling."""
