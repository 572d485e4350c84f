"""The socket of samples."""
