"""What a TMC4361 alone has, calculated."""
