"""The status bits that come with every reply, bit 0 first; "" is not used."""

from __future__ import annotations

STATUS_TMC428 = ("xEQt1", "RS1", "xEQt2", "RS2", "xEQt3", "RS3", "CDGW", "INT")
"""DS-TMC428 Table 6-4."""
STATUS_TMC4210 = ("xEQt1", "R_L", "", "GP_IN", "", "R_R", "", "INT")
"""DS-TMC4210 5.2.2.2."""
