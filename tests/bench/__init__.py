"""`make bench`: what was promised, measured, with its peer or limit in the same run."""

import sys
from pathlib import Path

# The server and the browser are started by the same modules as in scripts/; pytest has that folder on its path anyway.
sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
