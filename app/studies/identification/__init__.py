"""The study that tells what motor and machine hang on an axis."""
