"""Studies on plants drawn from a seed that they do not know; a module a study."""
