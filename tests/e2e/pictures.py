"""Pictures of pages in the documents: made by the test that does what they show, compared with today's page."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from PIL import Image, ImageChops, ImageStat

ALIKE = 12
"""Mean difference of two pictures in grey [of 255], from afar: curves differ from run to run, pages do not."""
FROM_AFAR = (64, 36)


def hold(made: Path, kept: Path) -> None:
    """Fail where the picture `made` just now shows another page than `kept`; STEPSCOPE_PICTURES has it kept first."""
    if os.environ.get("STEPSCOPE_PICTURES"):  # `make pictures`
        shutil.copy(made, kept)
    grey = [Image.open(path).convert("L").resize(FROM_AFAR) for path in (made, kept)]
    difference = float(ImageStat.Stat(ImageChops.difference(*grey)).mean[0])
    assert difference < ALIKE, f"{kept.name} shows a page that has changed since: make pictures ({difference:.1f})"
