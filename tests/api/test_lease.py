"""Who has the bench, over a clock that the test owns: any order of taking, asking, handing over, and silence."""

from __future__ import annotations

import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from app.clock import VirtualClock
from app.errors import UnknownThing, WrongState
from app.lease.errors import BenchNotTaken, BenchTaken
from app.lease.lease import ASK_STAYS_S, ASKING_MAX, Lease, LeaseEvent

ANNA, BEN, CARL = "session-of-anna-0001", "session-of-ben-00002", "session-of-carl-0003"
NAMES = {ANNA: "Anna", BEN: "Ben", CARL: "Carl"}


@pytest.fixture
def clock() -> VirtualClock:
    return VirtualClock(100.0)


@pytest.fixture
def lease(clock: VirtualClock) -> Lease:
    return Lease(clock, "stop", 15.0)


@pytest.fixture
def heard(lease: Lease) -> list[LeaseEvent]:
    events: list[LeaseEvent] = []
    lease.listen(events.append)
    return events


def pass_s(clock: VirtualClock, seconds: float) -> None:
    clock.set(clock.now() + seconds)


def test_free_it_is_borrowed_by_calls_and_looked_at_by_sessions(lease: Lease) -> None:
    assert lease.holder is None
    assert (lease.since_s, lease.expires_in_s) == (None, None)
    lease.require(None)
    with pytest.raises(BenchNotTaken, match="POST /lease"):
        lease.require(ANNA)


def test_one_has_it_and_the_others_are_told_who(lease: Lease, clock: VirtualClock) -> None:
    lease.take(ANNA, "Anna", "10.0.0.1")
    pass_s(clock, 4.0)
    lease.require(ANNA)
    for other in (None, BEN):
        with pytest.raises(BenchTaken, match="Anna has the bench") as refusal:
            lease.require(other)
        assert (refusal.value.holder, refusal.value.since_s, refusal.value.expires_in_s) == ("Anna", 4.0, 11.0)
        assert "POST /stop" in refusal.value.way_out
    with pytest.raises(BenchTaken):
        lease.take(BEN, "Ben")
    assert lease.name_of(ANNA) == "Anna"
    assert lease.name_of(BEN) is None


def test_who_gives_no_sign_has_vanished_at_that_moment(
    lease: Lease, clock: VirtualClock, heard: list[LeaseEvent]
) -> None:
    lease.take(ANNA, "Anna", "10.0.0.1")
    for _ in range(10):
        pass_s(clock, 14.9)
        lease.seen(ANNA)
    lease.seen(BEN)  # of others it means nothing
    pass_s(clock, 14.9)
    lease.seen(BEN)
    assert lease.is_holder(ANNA)
    pass_s(clock, 0.1)
    assert lease.holder is None
    assert [(event.action, event.name, event.address) for event in heard] == [
        ("taken", "Anna", "10.0.0.1"),
        ("vanished", "Anna", "10.0.0.1"),
    ]
    assert lease.holder is None
    assert len(heard) == 2  # told once


def test_coming_back_late_it_has_to_be_taken_again(lease: Lease, clock: VirtualClock) -> None:
    lease.take(ANNA, "Anna")
    pass_s(clock, 20.0)
    lease.seen(ANNA)
    with pytest.raises(BenchNotTaken, match="has ended"):
        lease.keep(ANNA)
    lease.take(BEN, "Ben")
    with pytest.raises(BenchTaken, match="Ben"):
        lease.keep(ANNA)


def test_handing_over_goes_to_one_who_asks(lease: Lease, clock: VirtualClock, heard: list[LeaseEvent]) -> None:
    lease.take(ANNA, "Anna")
    lease.ask(BEN, "Ben")
    pass_s(clock, 3.0)
    lease.ask(CARL, "Carl")
    lease.ask(BEN, "Ben B.")
    assert [(each.name, lease.waits_s(each)) for each in lease.asking] == [("Ben B.", 3.0), ("Carl", 0.0)]
    ben, carl = lease.asking
    for wrong in (BEN, ben.session, "nobody"):
        with pytest.raises(UnknownThing, match="asks for the bench"):
            lease.hand_over(ANNA, wrong)
    with pytest.raises(BenchTaken):
        lease.hand_over(BEN, carl.id)
    lease.hand_over(ANNA, ben.id)
    assert lease.is_holder(BEN)
    assert [each.name for each in lease.asking] == ["Carl"]
    assert heard[-1].action == "handed over"
    assert heard[-1].detail == "to Ben B."
    with pytest.raises(BenchTaken):
        lease.require(ANNA)


def test_a_question_that_is_not_repeated_is_gone(lease: Lease, clock: VirtualClock) -> None:
    lease.take(ANNA, "Anna")
    lease.ask(BEN, "Ben")
    pass_s(clock, ASK_STAYS_S - 0.1)
    lease.seen(ANNA)
    assert lease.asking
    pass_s(clock, 0.1)
    assert not lease.asking


def test_the_holder_has_nothing_to_ask(lease: Lease) -> None:
    lease.take(ANNA, "Anna")
    with pytest.raises(WrongState):
        lease.ask(ANNA, "Anna")


def test_many_questions_cost_little(lease: Lease) -> None:
    for number in range(ASKING_MAX + 5):
        lease.ask(f"session-number-{number}", f"{number}")
    assert [each.name for each in lease.asking] == [str(number) for number in range(5, ASKING_MAX + 5)]


def test_giving_back_what_one_has_not_got_is_no_error(lease: Lease, heard: list[LeaseEvent]) -> None:
    lease.take(ANNA, "Anna")
    lease.ask(BEN, "Ben")
    lease.give_back(BEN)
    assert lease.is_holder(ANNA)
    assert not lease.asking
    lease.give_back(ANNA)
    lease.give_back(ANNA)
    assert [event.action for event in heard] == ["taken", "given back"]


def test_what_happens_on_vanishing_is_the_holders_choice(
    lease: Lease, clock: VirtualClock, heard: list[LeaseEvent]
) -> None:
    with pytest.raises(BenchNotTaken):
        lease.set(ANNA, "hold")
    lease.take(ANNA, "Anna")
    lease.set(ANNA)
    lease.set(ANNA, "hold", 60.0)
    assert (lease.on_vanish, lease.vanish_after_s, lease.expires_in_s) == ("hold", 60.0, 60.0)
    with pytest.raises(BenchTaken):
        lease.set(BEN, "nothing")
    pass_s(clock, 59.0)
    assert lease.is_holder(ANNA)
    assert [event.action for event in heard] == ["taken", "set"]


class AnyOrder(RuleBasedStateMachine):
    """The lease beside a plain model of it: who has it, when they were seen last, who asks."""

    sessions = st.sampled_from([ANNA, BEN, CARL])

    @initialize(vanish_after_s=st.sampled_from([6.0, 15.0]))
    def begin(self, vanish_after_s: float) -> None:
        self.clock = VirtualClock()
        self.lease = Lease(self.clock, "stop", vanish_after_s)
        self.events: list[LeaseEvent] = []
        self.lease.listen(self.events.append)
        self.holder: str | None = None
        self.seen_s = 0.0
        self.asked_s: dict[str, float] = {}

    def _there(self) -> str | None:
        """The model's holder, now."""
        if self.holder is not None and self.clock.now() >= self.seen_s + self.lease.vanish_after_s:
            self.holder = None
        return self.holder

    @rule(seconds=st.floats(0, 20))
    def wait(self, seconds: float) -> None:
        pass_s(self.clock, seconds)

    @rule(session=sessions)
    def take(self, session: str) -> None:
        if self._there() in (None, session):
            self.lease.take(session, NAMES[session])
            if self.holder is None:
                self.asked_s.pop(session, None)
            self.holder, self.seen_s = session, self.clock.now()
        else:
            with pytest.raises(BenchTaken):
                self.lease.take(session, NAMES[session])

    @rule(session=sessions)
    def seen(self, session: str) -> None:
        self.lease.seen(session)
        if self._there() == session:
            self.seen_s = self.clock.now()

    @rule(session=sessions)
    def keep(self, session: str) -> None:
        there = self._there()
        if there == session:
            self.lease.keep(session)
            self.seen_s = self.clock.now()
        else:
            with pytest.raises(BenchNotTaken if there is None else BenchTaken):
                self.lease.keep(session)

    @rule(session=sessions)
    def give_back(self, session: str) -> None:
        self.lease.give_back(session)
        self.asked_s.pop(session, None)
        if self._there() == session:
            self.holder = None

    @rule(session=sessions)
    def ask(self, session: str) -> None:
        if self._there() == session:
            with pytest.raises(WrongState):
                self.lease.ask(session, NAMES[session])
        else:
            self.lease.ask(session, NAMES[session])
            self.asked_s[session] = self.clock.now()

    @rule(session=sessions, to=sessions)
    def hand_over(self, session: str, to: str) -> None:
        asking = {each.session: each.id for each in self.lease.asking}
        there = self._there()
        if there != session:
            with pytest.raises(BenchNotTaken if there is None else BenchTaken):
                self.lease.hand_over(session, asking.get(to, "nobody"))
            return
        self.seen_s = self.clock.now()
        if to not in asking:
            with pytest.raises(UnknownThing):
                self.lease.hand_over(session, to)
            return
        self.lease.hand_over(session, asking[to])
        self.holder = to
        del self.asked_s[to]

    @invariant()
    def only_one_may_change_anything(self) -> None:
        if not hasattr(self, "lease"):
            return
        there = self._there()
        allowed, refused_for = set(), None
        for session in (None, ANNA, BEN, CARL):
            try:
                self.lease.require(session)
            except BenchTaken as error:
                refused_for = error.holder
            except BenchNotTaken:
                assert there is None
            else:
                allowed.add(session)
        assert refused_for == (None if there is None else NAMES[there])
        assert allowed == {there}  # None stands for a call that borrows the free bench

    @invariant()
    def they_ask_who_asked_lately(self) -> None:
        if not hasattr(self, "lease"):
            return
        now_s = self.clock.now()
        lately = {session for session, asked_s in self.asked_s.items() if now_s < asked_s + ASK_STAYS_S}
        assert {each.session for each in self.lease.asking} == lately

    @invariant()
    def what_is_told_makes_sense(self) -> None:
        if not hasattr(self, "lease"):
            return
        has: str | None = None
        for event in self.events:
            if event.action == "taken":
                assert has is None
                has = event.name
            else:
                assert event.name == has
                has = event.detail.removeprefix("to ") if event.action == "handed over" else None
            assert not any(session in repr(event) for session in NAMES)
        assert has == (None if self.holder is None else NAMES[self.holder])


TestAnyOrder = AnyOrder.TestCase


def test_who_has_left_may_be_followed_at_once_or_come_back(
    lease: Lease, clock: VirtualClock, heard: list[LeaseEvent]
) -> None:
    lease.take(ANNA, "Anna", "10.0.0.1")
    assert [lease.leave(BEN), lease.left, lease.leave(ANNA), lease.left] == [False, False, True, True]
    with pytest.raises(BenchNotTaken):  # a session could take it
        lease.require(BEN)
    with pytest.raises(BenchTaken):  # a call without one cannot: motors may still be on their way
        lease.require(None)
    pass_s(clock, 14.0)
    lease.require(ANNA)  # the page was only loaded anew
    lease.seen(ANNA)
    assert not lease.left
    lease.end_left()
    assert lease.is_holder(ANNA)
    lease.leave(ANNA)
    lease.take(BEN, "Ben")
    assert lease.is_holder(BEN)
    lease.leave(BEN)
    lease.end_left()
    assert lease.holder is None
    assert [(event.action, event.name) for event in heard] == [
        ("taken", "Anna"),
        ("given back", "Anna"),
        ("taken", "Ben"),
        ("given back", "Ben"),
    ]


def test_who_has_left_vanishes_when_its_time_is_over(
    lease: Lease, clock: VirtualClock, heard: list[LeaseEvent]
) -> None:
    lease.take(ANNA, "Anna")
    pass_s(clock, 10.0)
    lease.leave(ANNA)  # is no sign of life
    pass_s(clock, 5.0)
    assert lease.holder is None
    assert [event.action for event in heard] == ["taken", "vanished"]
