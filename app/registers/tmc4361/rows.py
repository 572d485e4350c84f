"""What the rows of the TMC4361 share: units, sources, and what a field takes over from its word.

"DS-TMC4361" in a source stands for the TMC4361-LA data sheet. Our copy ends inside 9.1, before its register
chapter 17; what it does not tell is taken from later public sources, named as follows:

- TMC4361A: the vendor's TMC-API header of the later chip; PY4361: its PyTrinamic counterpart (one origin);
- KMARX: an older header of the vendor (driver TMC4361A_TMC2660);
- OLDC: the vendor's older C sources, which hold a table of resets;
- STEPPYR: register comments of alangibson/steppyr, taken from the data sheet's revision 3;
- TOM4361, TBONE, CAMILLE: drivers by tommag, trinamic/T-Bone, CamilleSelexis.

A register without a reset in any of them resets to 0, as all do that OLDC's table does not list.
"""

from __future__ import annotations

AXIS = 0

VELOCITY_UNIT = "1/256 pps"
ACCELERATION_UNIT = "1/4 pps^2"
BOW_UNIT = "pps^3"
CLOCKS = "tCLK"
MICROSTEPS = "microsteps"

LOW_HIGH = {0: "low active", 1: "high active"}
INACTIVE_ACTIVE = {0: "inactive", 1: "active"}

HEADERS = "TMC4361A; PY4361"
TOM = f"TOM4361; {HEADERS}"
TOM_TBONE = f"TOM4361; TBONE; {HEADERS}"
STEPPYR = f"STEPPYR; {HEADERS}"
TOM_STEPPYR = f"TOM4361; STEPPYR; {HEADERS}"
TOM_TBONE_STEPPYR = f"TOM4361; TBONE; STEPPYR; {HEADERS}"
