"""One connection to a chip or module, as the parts of its driver share it: queue, axes, limits, events."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass

from ...clock import Clock
from ...errors import BenchError, LinkError, UnknownThing, WrongState
from ...links.port import FramePort, SamplingPort
from ...links.queue import LinkQueue
from ...links.register_access import RegisterAccess
from ...links.registry import Link
from ...registers.catalog import MODELS, Model
from .config import AxisSettings, DeviceConfig
from .counter import CounterWritten, PositionSeen
from .events import DeviceEvent, MotionCommanded, StateChanged, motion_owner
from .limit_guard import LimitGuard
from .results import DeviceState

COUNTER_WRITES = frozenset({"set_position", "XACTUAL"})
"""Commands, as `Session.commanded` names them, after which the position counter of most chips shows another number for
the same place."""


@dataclass(slots=True)
class Axis:
    """One axis: its settings, and what is known of its chip setting without asking (None: nothing yet)."""

    index: int
    settings: AxisSettings
    pulse_div: int | None = None
    ramp_div: int | None = None
    microsteps_per_full_step: int | None = None

    @property
    def name(self) -> str:
        return self.settings.name

    @property
    def microsteps(self) -> tuple[int, int] | None:
        """Microsteps of a full step and of a turn; None where nobody knows how the chip is set."""
        full_step = self.microsteps_per_full_step
        return None if not full_step else (full_step, full_step * self.settings.full_steps_per_rev)


class Session:
    """A chip or module behind a link. All positions in microsteps, all times in device time [s].

    writes_counter : whether after a command, as `commanded` names it, the position counter shows another number for
        the same place
    queue : another way to the port than the connection's own, for the stop of whatever else answers there
    """

    def __init__(
        self,
        device_id: str,
        config: DeviceConfig,
        port: FramePort,
        clock: Clock,
        writes_counter: Callable[[str], bool] = COUNTER_WRITES.__contains__,
        queue: LinkQueue | None = None,
    ) -> None:
        self.id = device_id
        self.config = config
        self.port = port
        self.clock = clock
        """The server's, for what a driver does on its own."""
        self.background = clock
        """The same for what may wait while motors are being stopped: polling, not what keeps a motor in its limits."""
        self.queue = LinkQueue(port, on_result=self._link_result) if queue is None else queue
        self.axes = tuple(Axis(index, settings) for index, settings in enumerate(config.axes))
        self.limiter: LimitGuard | None = None
        """Keeps the soft limits of the axes; None where there are none (`limits.apply`)."""
        self.stops = [0] * len(self.axes)
        """How often each axis was stopped: a command that finds it changed was overtaken."""
        self.motion_commands = [0] * len(self.axes)
        """How many commands each axis got from this session that may move or stop it."""
        self.stranger: WrongState | None = None
        """Why what answers is not the chip or module of this connection; None where it is, or nobody knows."""
        self.inhibitors: list[Callable[[], WrongState | None]] = []
        """Each says why the driver keeps still although the link may work; None while it does not."""
        self.link_filters: list[Callable[[LinkError | None], bool]] = []
        """Each hears of a change between working and failing, and says whether it counts."""
        self.state_hooks: list[Callable[[DeviceState, BenchError | None], None]] = []
        """Parts that act on a state, each time it is set."""
        self.driven: Callable[[], Mapping[int, str]] = dict
        """Names of the devices that are drivers of axes of this one (`DeviceManager.drivers_of`), by axis."""
        self.writes_counter = writes_counter
        self.models_found: Callable[[RegisterAccess], Awaitable[tuple[str, ...]]] = _none_found
        """Models of any family that answer, by their own words, where this one does not (`families`). Only reads."""
        self._state: DeviceState = "disconnected"
        self._problem: BenchError | None = None
        self._listeners: list[Callable[[DeviceEvent], None]] = []

    # --- who it is ------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        return self.config.name

    @property
    def model(self) -> str:
        return self.config.model

    @property
    def family(self) -> Model:
        """The catalog's entry of this model."""
        return MODELS[self.config.model]

    @property
    def link(self) -> Link:
        return self.config.link

    @property
    def clock_hz(self) -> float:
        return self.config.clock_hz

    @property
    def emulated(self) -> bool:
        return self.config.link.get("kind") == "emulator"

    @property
    def sampling_port(self) -> SamplingPort | None:
        """The port, where its device samples itself on its own time."""
        return self.port.traits.sampling

    @property
    def chip_timed(self) -> bool:
        """Whether samples bear the device's own time."""
        return self.sampling_port is not None

    @property
    def calls_per_s_possible(self) -> float | None:
        """Questions a second that the wire can carry; None where it sets no limit."""
        line = self.port.traits.batches
        return None if line is None else line.wire.calls_per_s_possible

    @property
    def calls_per_s(self) -> float:
        """Questions a second that everybody on this wire asks."""
        line = self.port.traits.batches
        return self.queue.calls_per_s if line is None else line.wire.calls_per_s

    def device_time_s(self) -> float:
        """Now, device time [s]."""
        return self.port.device_time_s()

    @property
    def time_scale(self) -> float:
        """How fast device time runs against the server's: what an emulator's time scale turns."""
        return 1.0 if self.sampling_port is None else self.sampling_port.time_scale

    def axis(self, index: int) -> Axis:
        """Raises UnknownThing for an axis that the chip does not have."""
        if not 0 <= index < len(self.axes):
            raise UnknownThing("axis", str(index), [str(axis.index) for axis in self.axes])
        return self.axes[index]

    def reconfigure(self, device_id: str, config: DeviceConfig) -> None:
        """For the manager: another name, clock or other axes on the same link."""
        self.id, self.config = device_id, config
        for axis, settings in zip(self.axes, config.axes, strict=True):
            axis.settings = settings

    # --- whether it answers ---------------------------------------------------------------------

    @property
    def state(self) -> DeviceState:
        return self._state

    @property
    def problem(self) -> BenchError | None:
        """Why it is not connected; None while it is."""
        return self._problem

    def set_state(self, state: DeviceState, problem: BenchError | None = None) -> None:
        """For the manager."""
        if state == "failed" and self.limiter is not None:
            self.limiter.forget()
        self.queue.closed = state == "disconnected"
        if (state, problem) != (self._state, self._problem):
            self._state, self._problem = state, problem
            self.tell(StateChanged(state, problem))
        for hook in self.state_hooks:
            hook(state, problem)

    @property
    def held_back(self) -> WrongState | None:
        """Why the driver keeps still although the link may work; None while it does not."""
        if self.stranger is not None:
            return self.stranger
        return next((why for inhibitor in self.inhibitors if (why := inhibitor()) is not None), None)

    def require_connected(self) -> None:
        """Raises WrongState after a disconnect. A failed link is tried: it may be back."""
        if self._state == "disconnected":
            raise WrongState(f"{self.name} is not connected", "connect it first")

    def link_result(self, error: LinkError | None) -> None:
        """The link works (None), or failed."""
        if self._state == "disconnected":
            return
        if error is None and (why := self.held_back) is not None:
            self.set_state("failed", why)
        elif error is None:
            self.set_state("connected")
        else:
            self.set_state("failed", error)

    def _link_result(self, error: LinkError | None) -> None:
        if all(counts(error) for counts in self.link_filters):
            self.link_result(error)

    def stop_guard(self, axes: Sequence[int]) -> Callable[[], None]:
        """For turns of commands: raises WrongState as soon as one of `axes` was stopped after this call.

        Raises it at once where another chip or module answers: else the first thing missing in its registers would be
        told, and not who it is.
        """
        if axes and self.stranger is not None:
            raise self.stranger
        stops_then = [self.stops[axis] for axis in axes]

        def check() -> None:
            for axis, stops in zip(axes, stops_then, strict=True):
                if self.stops[axis] != stops:
                    raise WrongState(f"a stop of axis {axis} overtook this command", "send it again if it is wanted")

        return check

    # --- what happens ---------------------------------------------------------------------------

    def listen(self, listener: Callable[[DeviceEvent], None]) -> Callable[[], None]:
        """Hear of state changes and starts; returns the function that ends it. A listener must not raise."""
        self._listeners.append(listener)

        def end() -> None:
            if listener in self._listeners:
                self._listeners.remove(listener)

        return end

    def tell(self, event: DeviceEvent) -> None:
        """To everybody who listens."""
        for listener in tuple(self._listeners):
            listener(event)

    def commanded(self, axis: int, what: str, **asked: int | str) -> None:
        """For drivers: something that may move or stop `axis` is on its way to the chip; `asked` as in the event."""
        self.motion_commands[axis] += 1
        self.tell(MotionCommanded(axis, what, motion_owner.get(), asked))
        if self.writes_counter(what):
            self.tell(CounterWritten(axis, what))

    def saw_position(self, axis: int, count: int, asked_at_s: float, encoder_count: int | None = None) -> None:
        """For drivers: the position counter of `axis` was read, and with it the encoder's (see `PositionSeen`)."""
        if self.limiter is not None:
            self.limiter.at(axis, count)
        self.tell(PositionSeen(axis, count, asked_at_s, encoder_count))


async def _none_found(access: RegisterAccess) -> tuple[str, ...]:
    del access
    return ()
