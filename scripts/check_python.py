"""Says in one line what is missing when a machine's Python cannot make our virtual environment."""

import sys

# No annotations, no newer syntax: an old Python has to get as far as the sentence.
if sys.version_info < (3, 11):
    sys.exit(
        "stepscope needs Python >= 3.11, this is {}.{} ({}).\nName a newer one: make PYTHON=python3.12 run".format(
            sys.version_info[0], sys.version_info[1], sys.executable
        )
    )
try:
    import ensurepip  # noqa: F401
    import venv  # noqa: F401
except ImportError:
    sys.exit(
        "This Python cannot make virtual environments ({}).\n"
        "On Debian and Ubuntu: apt-get install python3-venv\n"
        "Or name another one: make PYTHON=/path/to/python3 run".format(sys.executable)
    )
