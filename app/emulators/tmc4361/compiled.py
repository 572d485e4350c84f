"""How this package compiles: as the other kernels, but over several files.

Constants and callees of a function stand in other files than the function, and stale machine code of a chip would be a
nasty thing to look for. So what is compiled here is good as long as every file with compiled code or its layout is the
same, the motor's included.
"""

from __future__ import annotations

from pathlib import Path

from ...kernels import Kernels

_HERE = Path(__file__).parent
_KERNELS = Kernels(
    *(file for file in _HERE.rglob("*.py") if "compiled import" in file.read_text(encoding="utf-8")),
    _HERE / "layout.py",
    _HERE / "feedback/layout.py",
    _HERE.parent / "drive/kernel.py",
    plain=True,
    views=True,
)
compiled, inlined = _KERNELS.compiled, _KERNELS.inlined
