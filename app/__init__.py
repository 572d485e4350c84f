"""stepscope: a web dashboard that configures and tunes stepper motion controllers.

The tree says what may know what; `docs/architecture.md` draws it and import-linter holds it.
"""

__version__ = "0.1.0"
