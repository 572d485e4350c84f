"""Whether a module is in download mode, and what that makes of its connection."""

from __future__ import annotations

from ...errors import DownloadMode
from ...links.download import DownloadHold, Downloads
from ...links.serial_line import LinePort
from ..core.session import Session


def download_hold(session: Session, address: int) -> DownloadHold:
    """Follows the download mode of the module at `address`: in it nothing goes out, where the queue asks this hold, but
    what its user sends, and stops; the connection counts as failed, and an emulator takes no samples."""
    port = session.port

    def changed() -> None:
        why = hold.problem
        if session.sampling_port is not None:
            session.sampling_port.paused = why
        if session.state == "disconnected":
            return
        if why is not None:
            session.set_state("failed", why)
        elif isinstance(session.problem, DownloadMode):
            # What was not learnt while nothing could be asked, the watch asks now.
            session.set_state("connecting")

    if isinstance(port, LinePort):
        hold = DownloadHold(port.line.downloads, port.address, port.address_of, changed)
    else:
        hold = DownloadHold(Downloads(), address, lambda frame: frame[0], changed)
    session.inhibitors.append(lambda: hold.problem)
    return hold
