"""The study of ripple over speed and order, and of which setting moves it."""
