"""How connections come in: the kinds of links, each with its own options."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self, get_args

from pydantic import BaseModel, Discriminator, Field, StringConstraints, Tag, model_validator

from ...deferred import DeferredRootModel
from ...emulators.listed.options import ListedOptions
from ...emulators.tmc5xxx.options import Tmc5xxxOptions
from ...emulators.tmc428.options import EmulatorOptions
from ...emulators.tmc4361.options import Tmc4361Options
from ...emulators.tmcdrivers.options import TmcDriverOptions
from ...emulators.tmcl.options import TmclOptions
from ...form_hints import form, rest_only, shown
from ...registers.catalog import kind_of
from ...registers.names import AnyModelName, DriverName, ListedName, ModuleName
from ..calc.schemas import ClockHz
from ..links.schemas import Address, Baud
from ..schemas import AxisConfig, Body, Chip40Name, ChipName, Flag, Name, Tmc5xxxName

HOST = (
    r"^[A-Za-z0-9_]([A-Za-z0-9_-]{0,62})(\.[A-Za-z0-9_-]{1,63})*\.?$|^[0-9A-Fa-f:.]*:[0-9A-Fa-f:.]*(%[A-Za-z0-9_-]+)?$"
)
"""A name of labels of up to 63 characters, an IPv4 address (which looks like one), or an IPv6 address."""

Host = Annotated[str, StringConstraints(strict=True, max_length=253, pattern=HOST)]
TcpPortNumber = Annotated[int, Field(strict=True, ge=1, le=65_535)]
Seconds = Annotated[float, Field(strict=True, ge=0.001, le=60, allow_inf_nan=False)]
CanId = Annotated[int, Field(strict=True, ge=1, le=0x7FF)]
Text = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=200)]
SerialPort = Annotated[
    Text,
    Field(
        description="device name, or an address of pyserial: socket://, rfc2217://, spy://",
        json_schema_extra=form(ports=True),
    ),
]
LineSeconds = Annotated[
    Seconds, Field(title="Answer within", description="how long to wait for an answer, beyond its own time [s]")
]
LineBaud = Annotated[
    Baud,
    Field(
        title="Baud (not on USB)",
        description="without meaning on USB",
        examples=[9600, 14400, 19200, 28800, 38400, 57600, 76800, 115200, 230400, 250000, 500000, 1000000],
    ),
]


class EmulatorLink(EmulatorOptions):
    """A chip emulated in this server. Without options it gets a motor and a stage on each axis."""

    kind: Literal["emulator"]


class Chip40EmulatorLink(Tmc4361Options):
    """A chip emulated in this server, with a motor, a stage and an encoder."""

    kind: Literal["emulator"]


class SixPointEmulatorLink(Tmc5xxxOptions):
    """A TMC5xxx emulated in this server, with motors, stages and encoders."""

    kind: Literal["emulator"]


class DriverEmulatorLink(TmcDriverOptions):
    """A driver emulated in this server, with a motor."""

    kind: Literal["emulator"]


class TcpLink(Body):
    """A chip behind a TCP socket: raw frames both ways (TMC428 and TMC4210: 4 bytes, else 5), as by
    `stepscope emulate`."""

    kind: Literal["tcp"]
    host: Host = Field(
        title="Host", description="name or address of the machine", json_schema_extra=form(proposed="127.0.0.1")
    )
    port: TcpPortNumber = Field(title="Port", description="as the program or adapter there says it", examples=[4280])
    timeout_s: Seconds = shown(1.0, "Answer within", "how long to wait for an answer [s]")


class ModuleEmulatorLink(TmclOptions):
    """A module emulated in this server, with a motor, a stage and encoders."""

    kind: Literal["emulator"]
    eeprom: Annotated[str, StringConstraints(strict=True, pattern=r"^[a-z0-9][a-z0-9-]{0,63}$")] | None = rest_only(
        None,
        "name of its memory in the server's data directory, small letters, digits and dashes; a new "
        "device without one gets one of its own, so that what it stores outlives the server",
    )


class ModuleTcpLink(Body):
    """A module behind a TCP socket: 9-byte TMCL frames both ways. Several modules may share the socket."""

    kind: Literal["tcp"]
    host: Host = Field(
        title="Host", description="name or address of the machine", json_schema_extra=form(proposed="127.0.0.1")
    )
    port: TcpPortNumber = Field(title="Port", description="as the program or adapter there says it", examples=[4242])
    address: Address = shown(1, "Module address", "the module's address on the line")
    timeout_s: Seconds = shown(1.0, "Answer within", "how long to wait for an answer [s]")


class ModuleSerialLink(Body):
    """A module on USB, RS485 or RS232. Several modules may share the line, each by its address."""

    kind: Literal["serial"]
    port: SerialPort = Field(title="Port or address")
    baud: LineBaud = 9600
    address: Address = shown(1, "Module address", "the module's address on the line")
    timeout_s: LineSeconds = 0.25


class ModuleCanLink(Body):
    """A module on CAN, through python-can (the extra "can")."""

    kind: Literal["can"]
    interface: Text = Field(
        title="Interface of python-can",
        description="of python-can: socketcan, pcan, virtual, ...",
        examples=["socketcan", "pcan", "slcan", "kvaser", "ixxat", "vector", "gs_usb", "virtual"],
        json_schema_extra=form(proposed="socketcan"),
    )
    channel: Text = Field(
        title="Channel", description="as the interface calls it: can0, ...", json_schema_extra=form(proposed="can0")
    )
    bitrate: Annotated[int, Field(strict=True, ge=10_000, le=1_000_000)] = Field(
        default=1_000_000,
        title="Bit rate",
        description="of every node on the bus [bit/s]",
        examples=[20_000, 50_000, 100_000, 125_000, 250_000, 500_000, 1_000_000],
    )
    timeout_s: Seconds = shown(0.25, "Answer within", "how long to wait for an answer [s]")
    send_id: CanId = shown(1, "The module listens to id", "what the module listens to (global parameter 71)")
    receive_id: CanId = shown(2, "It answers under id", "what the module answers under (global parameter 70)")


class SpidevLink(Body):
    """A chip at an SPI bus of the server's machine, through Linux's spidev (the extra "spidev")."""

    kind: Literal["spidev"]
    bus: Annotated[int, Field(strict=True, ge=0, le=255)] = Field(
        title="Bus", description="B of /dev/spidevB.D", json_schema_extra=form(proposed="0")
    )
    device: Annotated[int, Field(strict=True, ge=0, le=255)] = Field(
        title="Chip select", description="D of /dev/spidevB.D", json_schema_extra=form(proposed="0")
    )
    speed_hz: Annotated[int, Field(strict=True, ge=10_000, le=16_000_000)] = shown(
        1_000_000,
        "Clock of the bus",
        "a quarter of the chip's clock is safe, of a chip with 32-bit datagrams an eighth [Hz]",
    )
    mode: Annotated[int, Field(strict=True, ge=0, le=3)] = shown(
        3, "SPI mode", "clock polarity and phase: the chips use 3"
    )


class LandungsbrueckeLink(Body):
    """A chip on an evaluation board with a base board (Landungsbruecke, Startrampe) on USB."""

    kind: Literal["landungsbruecke"]
    port: SerialPort = Field(title="Port of the board")
    timeout_s: LineSeconds = 0.25
    baud: LineBaud = 115_200
    motor: Annotated[int, Field(strict=True, ge=0, le=15)] = shown(0, "Motor of the board", "the board's channel")


class UartLink(Body):
    """A chip on the single wire of its UART. Several may share the wire, each by its node address."""

    kind: Literal["uart"]
    port: SerialPort = Field(title="Port of the UART")
    baud: Annotated[int, Field(strict=True, ge=9000, le=4_000_000)] = Field(
        default=115_200,
        title="Baud",
        description="the chip measures it: at most a sixteenth of its clock",
        examples=[9600, 19_200, 57_600, 115_200, 230_400, 250_000, 460_800, 500_000],
    )
    node: Annotated[int, Field(strict=True, ge=0, le=254)] = shown(
        0,
        "Node address",
        "NODEADDR, plus 1 where NEXTADDR is high; of a TMC2209 MS1 and 2 MS2; a TMC5062 has none",
        where={"uart": ["node"]},
    )
    timeout_s: LineSeconds = 0.25
    echo: Literal["auto", "on", "off"] = shown(
        "auto",
        "What is sent comes back as an echo",
        "whether what is sent comes back, as on a single wire; auto finds out",
        words={
            "auto": "found out when connecting",
            "on": "yes: one wire both ways",
            "off": "no: the adapter takes it off",
        },
    )


class CoverLink(Body):
    """A driver behind a controller that carries its datagrams: on the chain of a TMC428, at the output of a TMC4361."""

    kind: Literal["cover"]
    device: Text = Field(
        title="Controller",
        description="id of the device whose axis it drives",
        json_schema_extra=form(proposed="bench"),
    )
    axis: Annotated[int, Field(strict=True, ge=0, le=7)] = shown(0, "Its axis", "the axis of the controller, from 0")


class ListedEmulatorLink(ListedOptions):
    """Emulated in this server, plainly: what was written is held, axes move by their own speed and acceleration."""

    kind: Literal["emulator"]


ChipLink = Annotated[EmulatorLink | TcpLink | SpidevLink, Field(discriminator="kind")]
Chip40Link = Annotated[Chip40EmulatorLink | TcpLink | SpidevLink | LandungsbrueckeLink, Field(discriminator="kind")]
SixPointLink = Annotated[
    SixPointEmulatorLink | TcpLink | SpidevLink | LandungsbrueckeLink | UartLink, Field(discriminator="kind")
]
DriverLink = Annotated[
    DriverEmulatorLink | TcpLink | SpidevLink | LandungsbrueckeLink | UartLink | CoverLink, Field(discriminator="kind")
]
ModuleLink = Annotated[
    ModuleEmulatorLink | ModuleTcpLink | ModuleSerialLink | ModuleCanLink, Field(discriminator="kind")
]
ListedLink = Annotated[
    ListedEmulatorLink | ModuleTcpLink | ModuleSerialLink | ModuleCanLink, Field(discriminator="kind")
]
ListedChipLink = Annotated[
    ListedEmulatorLink | TcpLink | SpidevLink | LandungsbrueckeLink | UartLink, Field(discriminator="kind")
]
AnyLink = (
    EmulatorLink
    | TcpLink
    | SpidevLink
    | LandungsbrueckeLink
    | UartLink
    | CoverLink
    | Chip40EmulatorLink
    | SixPointEmulatorLink
    | DriverEmulatorLink
    | ModuleEmulatorLink
    | ModuleTcpLink
    | ModuleSerialLink
    | ModuleCanLink
    | ListedEmulatorLink
)
Axes = Annotated[list[AxisConfig], Field(max_length=8)]


class _Create(Body):
    """Axes that are not given get defaults."""

    name: Name = Field(title="Name", description="the device goes by it everywhere")
    clock_hz: ClockHz | None = Field(default=None, description="the chip's clock [Hz]; null: 16 MHz")
    axes: Axes | None = None
    start_up: Flag = Field(
        default=False,
        description="of an emulator: set it up whenever it is powered, by the defaults of POST .../start-up, so that "
        "it can move at once; else it is as after power-on",
    )

    @model_validator(mode="after")
    def _only_an_emulator(self) -> Self:
        link: AnyLink | None = getattr(self, "link", None)
        if self.start_up and link is not None and link.kind != "emulator":
            raise ValueError("start_up is for emulators: of hardware look at POST .../start-up with dry_run first")
        return self


class ChipCreate(_Create):
    """A connection to a chip. Axes that are not given get defaults."""

    model: ChipName
    link: ChipLink


class Chip40Create(_Create):
    """A connection to a chip of 40-bit datagrams. An axis that is not given gets defaults."""

    model: Chip40Name
    link: Chip40Link


class SixPointCreate(_Create):
    """A connection to a TMC5xxx. Axes that are not given get defaults."""

    model: Tmc5xxxName
    link: SixPointLink


class DriverCreate(_Create):
    """A connection to a driver that is stepped from outside."""

    model: DriverName
    link: DriverLink


class ModuleCreate(_Create):
    """A connection to a module. Axes that are not given get defaults."""

    model: ModuleName
    link: ModuleLink


class ListedCreate(_Create):
    """A connection to a module that an installed package lists. Axes that are not given get defaults."""

    model: ListedName
    link: ListedLink


class ListedChipCreate(_Create):
    """A connection to a chip of which a table of registers is known. Axes that are not given get defaults."""

    model: ListedName
    link: ListedChipLink


OF_MODELS: dict[str, object] = {
    "chip": ChipName,
    "chip40": Chip40Name,
    "sixpoint": Tmc5xxxName,
    "driver": DriverName,
    "module": ModuleName,
}


def of_model(body: object) -> str:
    """Whose shape a body has, by its model; that of a listed one where no other knows it."""
    name = body.get("model") if isinstance(body, dict) else getattr(body, "model", None)
    other = "listed-chip" if isinstance(name, str) and kind_of(name) == "chip" else "listed"
    return next((tag for tag, names in OF_MODELS.items() if name in get_args(names)), other)


class DeviceCreate(
    DeferredRootModel[
        Annotated[
            Annotated[ChipCreate, Tag("chip")]
            | Annotated[Chip40Create, Tag("chip40")]
            | Annotated[SixPointCreate, Tag("sixpoint")]
            | Annotated[DriverCreate, Tag("driver")]
            | Annotated[ModuleCreate, Tag("module")]
            | Annotated[ListedCreate, Tag("listed")]
            | Annotated[ListedChipCreate, Tag("listed-chip")],
            Discriminator(of_model),
        ]
    ]
):
    """A connection: the model, and a link that suits it."""


class ChipTrial(Body):
    """A link to a chip, to be tried."""

    model: ChipName
    link: ChipLink


class Chip40Trial(Body):
    """A link to a chip of 40-bit datagrams, to be tried."""

    model: Chip40Name
    link: Chip40Link


class SixPointTrial(Body):
    """A link to a TMC5xxx, to be tried."""

    model: Tmc5xxxName
    link: SixPointLink


class DriverTrial(Body):
    """A link to a driver, to be tried."""

    model: DriverName
    link: DriverLink


class ModuleTrial(Body):
    """A link to a module, to be tried."""

    model: ModuleName
    link: ModuleLink


class ListedTrial(Body):
    """A link to a module that an installed package lists, to be tried."""

    model: ListedName
    link: ListedLink


class ListedChipTrial(Body):
    """A link to a chip of which a table of registers is known, to be tried."""

    model: ListedName
    link: ListedChipLink


class DeviceTrial(
    DeferredRootModel[
        Annotated[
            Annotated[ChipTrial, Tag("chip")]
            | Annotated[Chip40Trial, Tag("chip40")]
            | Annotated[SixPointTrial, Tag("sixpoint")]
            | Annotated[DriverTrial, Tag("driver")]
            | Annotated[ModuleTrial, Tag("module")]
            | Annotated[ListedTrial, Tag("listed")]
            | Annotated[ListedChipTrial, Tag("listed-chip")],
            Discriminator(of_model),
        ]
    ]
):
    """A link to be tried."""


EMULATORS: dict[str, type[BaseModel]] = {
    "emulator": EmulatorOptions,
    "chip40-emulator": Tmc4361Options,
    "sixpoint-emulator": Tmc5xxxOptions,
    "driver-emulator": TmcDriverOptions,
    "module-emulator": TmclOptions,
}


def _which(link: object) -> str:
    """Which of the links is meant, where the model is not there to tell: by its kind, then by its options."""
    if not isinstance(link, dict):
        return ""
    kind = link.get("kind")
    if kind == "emulator":
        options = set(link) - {"kind"}
        fits = (tag for tag, known in EMULATORS.items() if options <= known.model_fields.keys())
        return next(fits, "module-emulator")
    if kind == "tcp":
        return "module-tcp" if "address" in link else "tcp"
    return str(kind)


def _any_of(schema: dict[str, Any]) -> None:
    # A link may fit a chip and a module as well, and "one of" would then say that it fits neither.
    schema["anyOf"] = schema.pop("oneOf", schema.get("anyOf"))


class DeviceChange(Body):
    """What to change; what is left out stays. The link has to suit the model."""

    name: Name | None = None
    model: AnyModelName | None = Field(
        default=None, description="what really answers there; another model is another connection over the same link"
    )
    link: (
        Annotated[
            Annotated[EmulatorLink, Tag("emulator")]
            | Annotated[Chip40EmulatorLink, Tag("chip40-emulator")]
            | Annotated[SixPointEmulatorLink, Tag("sixpoint-emulator")]
            | Annotated[DriverEmulatorLink, Tag("driver-emulator")]
            | Annotated[TcpLink, Tag("tcp")]
            | Annotated[SpidevLink, Tag("spidev")]
            | Annotated[LandungsbrueckeLink, Tag("landungsbruecke")]
            | Annotated[UartLink, Tag("uart")]
            | Annotated[ModuleEmulatorLink, Tag("module-emulator")]
            | Annotated[ModuleTcpLink, Tag("module-tcp")]
            | Annotated[ModuleSerialLink, Tag("serial")]
            | Annotated[ModuleCanLink, Tag("can")],
            Discriminator(_which),
            Field(json_schema_extra=_any_of),
        ]
        | None
    ) = None
    clock_hz: ClockHz | None = None
    axes: Axes | None = None
