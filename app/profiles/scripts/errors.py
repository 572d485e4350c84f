"""Why a script is not offered."""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import BenchError


class ScriptFailed(BenchError):
    """The script ran on an emulator and did not leave it as the profile says, or did not run at all."""

    def __init__(self, language: str, model: str, why: str, differences: Sequence[str] = ()) -> None:
        super().__init__(f"the {language} script was tried on an emulated {model} and is not offered: {why}")
        self.language = language
        self.model = model
        self.differences = list(differences)
        self.way_out = "look at the values named; a profile that was captured from a device can be written to one"
