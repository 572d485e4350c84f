"""Who has the bench: one session at a time may change anything, and only as long as it shows that it is there.

Sessions only look until they take the free bench. The holder keeps it by any sign of life, may hand it over to one who
asks, or gives it back; after `vanish_after_s` without a sign it has vanished, the bench is free, and what `on_vanish`
says happens to the motors (`lease_watch`). One whose last page was closed has left: the next session that wants the
bench takes it, and a sign of life before that (the page was only loaded anew) is a return. A call without a session
borrows the free bench for as long as it takes.

Everything here is a plain function of a clock. That time has passed is noticed by whoever looks next.
"""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from ..clock import Clock
from ..errors import UnknownThing, WrongState
from ..settings import OnVanish
from .errors import BenchNotTaken, BenchTaken

ASK_STAYS_S = 15.0
"""How long a question to the holder stands that is not repeated [s]."""
ASKING_MAX = 20
"""More than that are not shown to the holder; the oldest question goes."""

LeaseAction = Literal["taken", "given back", "handed over", "vanished", "set"]


@dataclass(frozen=True, slots=True)
class LeaseEvent:
    """The lease changed: for the audit log, and for what has to happen then."""

    action: LeaseAction
    name: str
    """Who had it, or took it."""
    address: str
    """Where that session's latest request came from."""
    detail: str
    """For people: to whom, since when..."""


@dataclass(slots=True)
class Holder:
    """The session that has the bench. Times are the clock's [s]."""

    session: str
    name: str
    address: str
    since_s: float
    seen_s: float
    left: bool = False
    """Its last page was closed, and nothing was heard of it since."""


@dataclass(slots=True)
class Asker:
    """A session that would like to have it. `id` is public, the session is not."""

    id: str
    session: str
    name: str
    address: str
    since_s: float
    asked_s: float


class Lease:
    """The bench's one lease."""

    def __init__(self, clock: Clock, on_vanish: OnVanish = "stop", vanish_after_s: float = 15.0) -> None:
        self._clock = clock
        self._listeners: list[Callable[[LeaseEvent], None]] = []
        self._holder: Holder | None = None
        self._asking: list[Asker] = []
        self.on_vanish: OnVanish = on_vanish
        self.vanish_after_s = vanish_after_s

    def listen(self, listener: Callable[[LeaseEvent], None]) -> None:
        """Hear of every change, when it is done. A listener must not raise."""
        self._listeners.append(listener)

    # --- looking --------------------------------------------------------------------------------

    @property
    def holder(self) -> Holder | None:
        """Who has the bench; None while it is free."""
        holder = self._holder
        if holder is not None and self._clock.now() >= holder.seen_s + self.vanish_after_s:
            self._holder = None
            quiet = f"no sign for {self.vanish_after_s:g} s; for the motors: {self.on_vanish}"
            self._tell(LeaseEvent("vanished", holder.name, holder.address, quiet))
        return self._holder

    @property
    def expires_in_s(self) -> float | None:
        """When the holder will have vanished without another sign [s]; None while the bench is free."""
        holder = self.holder
        return None if holder is None else holder.seen_s + self.vanish_after_s - self._clock.now()

    @property
    def since_s(self) -> float | None:
        """How long the holder has had it [s]."""
        holder = self.holder
        return None if holder is None else self._clock.now() - holder.since_s

    @property
    def left(self) -> bool:
        """Whether the holder's last page was closed: any other session may take the bench."""
        holder = self.holder
        return holder is not None and holder.left

    @property
    def asking(self) -> tuple[Asker, ...]:
        """Who would like to have it, the longest waiting first."""
        now_s = self._clock.now()
        self._asking = [asker for asker in self._asking if now_s < asker.asked_s + ASK_STAYS_S]
        return tuple(self._asking)

    def waits_s(self, asker: Asker) -> float:
        """How long that one has been asking [s]."""
        return self._clock.now() - asker.since_s

    def is_holder(self, session: str | None) -> bool:
        """Whether that session has the bench."""
        holder = self.holder
        return holder is not None and session is not None and _same(session, holder.session)

    def name_of(self, session: str) -> str | None:
        """The name that this session took the bench under, while it has it."""
        holder = self.holder
        return holder.name if holder is not None and _same(session, holder.session) else None

    def require(self, session: str | None) -> None:
        """Whether a call may change something: the holder's, or one without a session while the bench is free.

        Raises BenchTaken, or BenchNotTaken for a session that could have taken it.
        """
        if self.holder is None or (self.left and session is not None and not self.is_holder(session)):
            if session is not None:
                raise BenchNotTaken
        elif not self.is_holder(session):
            raise self._taken()

    # --- changing -------------------------------------------------------------------------------

    def take(self, session: str, name: str, address: str = "") -> None:
        """Take the free bench, or keep it under that name. Raises BenchTaken."""
        holder, now_s = self.holder, self._clock.now()
        if holder is not None and holder.left and not _same(session, holder.session):
            self._give_back(holder, f"its page was closed; to {name}")
            holder = None
        if holder is None:
            self._put(Holder(session, name, address, now_s, now_s))
            self._tell(LeaseEvent("taken", name, address, ""))
        elif _same(session, holder.session):
            holder.name, holder.address = name, address
            self.seen(session)
        else:
            raise self._taken()

    def seen(self, session: str) -> None:
        """A sign of life: any request of that session is one. Of others it means nothing."""
        holder = self.holder
        if holder is not None and _same(session, holder.session):
            holder.seen_s, holder.left = self._clock.now(), False

    def quiet_s(self, session: str) -> float | None:
        """How long nothing was heard of that session [s]; None when it has not got the bench."""
        holder = self.holder
        if holder is None or not _same(session, holder.session):
            return None
        return self._clock.now() - holder.seen_s

    def leave(self, session: str) -> bool:
        """The last page of that session closes, or is loaded anew: no sign of life. Returns whether it has the bench.

        Its time runs on: without a return it will have vanished when it would have.
        """
        holder = self.holder
        if holder is None or not _same(session, holder.session):
            return False
        holder.left = True
        return True

    def end_left(self) -> None:
        """Free the bench whose holder has left, unless that one is back: nothing is there to stop."""
        holder = self.holder
        if holder is not None and holder.left:
            self._give_back(holder, "its page was closed, and nothing moved")

    def keep(self, session: str) -> None:
        """Stay. Raises BenchTaken, or BenchNotTaken where the lease has ended meanwhile."""
        holder = self.holder
        if holder is None:
            raise BenchNotTaken("the lease of this session has ended, or never was")
        if not _same(session, holder.session):
            raise self._taken()
        self.seen(session)

    def set(self, session: str, on_vanish: OnVanish | None = None, vanish_after_s: float | None = None) -> None:
        """What happens when a holder vanishes, and after how long [s]: until the server ends. Raises as `keep`."""
        self.keep(session)
        before = (self.on_vanish, self.vanish_after_s)
        self.on_vanish = on_vanish or self.on_vanish
        self.vanish_after_s = vanish_after_s or self.vanish_after_s
        if self._holder is not None and before != (self.on_vanish, self.vanish_after_s):
            what = f"on vanishing after {self.vanish_after_s:g} s: {self.on_vanish}"
            self._tell(LeaseEvent("set", self._holder.name, self._holder.address, what))

    def give_back(self, session: str) -> None:
        """The bench is free again. Of a session that has not got it, nothing is to give: no error."""
        holder = self.holder
        if holder is not None and _same(session, holder.session):
            self._give_back(holder, "")
        self._forget(session)

    def ask(self, session: str, name: str, address: str = "") -> None:
        """Ask the holder for the bench; stands for `ASK_STAYS_S`, so it is repeated. Raises WrongState for the holder.

        Of a free bench nothing has to be asked: it is simply taken.
        """
        if self.is_holder(session):
            raise WrongState("this session has the bench itself", "others ask, then POST /lease/hand-over")
        now_s = self._clock.now()
        for asker in self.asking:
            if _same(session, asker.session):
                asker.name, asker.address, asker.asked_s = name, address, now_s
                return
        self._asking.append(Asker(secrets.token_hex(4), session, name, address, now_s, now_s))
        del self._asking[:-ASKING_MAX]

    def hand_over(self, session: str, to: str) -> None:
        """Give it to one who asks, by that one's id. Raises UnknownThing, and as `keep`."""
        self.keep(session)
        holder = self._holder
        asker = next((each for each in self.asking if each.id == to), None)
        if asker is None or holder is None:
            raise UnknownThing("session that asks for the bench", to, [each.id for each in self.asking])
        now_s = self._clock.now()
        self._put(Holder(asker.session, asker.name, asker.address, now_s, now_s))
        self._tell(LeaseEvent("handed over", holder.name, holder.address, f"to {asker.name}"))

    # --- inside ---------------------------------------------------------------------------------

    def _give_back(self, holder: Holder, detail: str) -> None:
        self._holder = None
        self._tell(LeaseEvent("given back", holder.name, holder.address, detail))

    def _tell(self, event: LeaseEvent) -> None:
        for listener in self._listeners:
            listener(event)

    def _put(self, holder: Holder) -> None:
        self._holder = holder
        self._forget(holder.session)

    def _forget(self, session: str) -> None:
        self._asking = [asker for asker in self._asking if not _same(session, asker.session)]

    def _taken(self) -> BenchTaken:
        holder = self._holder
        assert holder is not None
        return BenchTaken(holder.name, self.since_s or 0.0, self.expires_in_s or 0.0)


def _same(session: str, other: str) -> bool:
    # A secret like a password, so compared like one.
    return hmac.compare_digest(session.encode("utf-8", "replace"), other.encode("utf-8", "replace"))
