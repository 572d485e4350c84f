"""One typed settings object: flags of the command line win over STEPSCOPE_* variables, these over defaults."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from platformdirs import user_data_path
from pydantic import Field, SecretStr, ValidationInfo, field_validator, model_validator
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict

TOKEN_LENGTH_MIN = 8
LogLevel = Literal["debug", "info", "warning", "error"]
OnVanish = Literal["nothing", "stop", "hold"]
"""What happens to moving motors when the session that has the bench gives no sign any more."""
VANISH_AFTER_S = (6.0, 3600.0)
"""Shortest and longest time without a sign after which a session has vanished; a sign is due every 5 s."""


class Settings(BaseSettings):
    """What a server may be told. Every field is also a variable, e.g. STEPSCOPE_PORT=8001."""

    model_config = SettingsConfigDict(env_prefix="STEPSCOPE_", frozen=True, extra="forbid")

    host: str = Field(default="127.0.0.1", description="address to listen on; 0.0.0.0 opens the bench to the network")
    port: Annotated[int, Field(ge=0, le=65_535)] = Field(default=8000, description="0 picks a free one")
    data_dir: Path = Field(
        default_factory=lambda: user_data_path("stepscope", appauthor=False),
        description="where connections and profiles are kept",
    )
    demo: bool | None = Field(
        default=None, description="the emulated demo bench: yes, no, or (unset) only while no connection is saved"
    )
    web_dir: Path = Field(default=Path(__file__).parent / "_web", description="the built browser UI")
    help_dir: Path = Field(default=Path(__file__).parent / "_help", description="the built help")
    log_level: LogLevel = "info"
    allowed_hosts: Annotated[tuple[str, ...], NoDecode] = Field(
        default=(), description="host names, comma-separated, under which browsers may reach this server"
    )
    allowed_ports: Annotated[tuple[str, ...], NoDecode] = Field(
        default=(),
        description="devices, comma-separated, as patterns (/dev/motor*), that may be opened though the system does not"
        " list them as serial ports and they are not called like one",
    )
    history_minutes: Annotated[float, Field(gt=0, le=24 * 60)] = Field(
        default=10.0, description="how much of every connected device the server remembers [min]"
    )
    token: SecretStr | None = Field(
        default=None,
        description="what a client has to know; unset: none on this machine's own address, a new one on any other",
    )
    token_file: Path | None = Field(
        default=None,
        description="a file with that token, for its owner alone; made with a new one at the first start",
    )
    tls_cert: Path | None = Field(default=None, description="certificate (PEM) for https; with its chain")
    tls_key: Path | None = Field(default=None, description="the certificate's key (PEM)")
    body_limit_bytes: Annotated[int, Field(ge=1024)] = Field(
        default=1 << 20, description="the longest request body that is read [bytes]"
    )
    disk_reserve_mb: Annotated[float, Field(ge=0)] = Field(
        default=256.0, description="of the disk this is not for recordings: they end before they take it [MB]"
    )

    dask: str | None = Field(
        default=None,
        pattern=r"^(tcp|tls)://[^/\s]+:[0-9]{1,5}$",
        description="address of a Dask scheduler (tcp://HOST:PORT) whose workers run the emulated twins of studies;"
        " unset: processes of this machine",
    )
    on_vanish: OnVanish = Field(
        default="stop",
        description="what happens to moving motors when the session that has the bench vanishes: nothing; stop: all"
        " are ramped down; hold: rotations and procedures end, moves to a target run to their end",
    )
    vanish_after_s: Annotated[float, Field(ge=VANISH_AFTER_S[0], le=VANISH_AFTER_S[1])] = Field(
        default=15.0, description="without a sign for so long, a session has vanished [s]"
    )

    @field_validator("token")
    @classmethod
    def _worth_having(cls, value: SecretStr | None) -> SecretStr | None:
        if value is not None and len(value.get_secret_value().strip()) < TOKEN_LENGTH_MIN:
            raise ValueError(f"a token has at least {TOKEN_LENGTH_MIN} characters")
        return value

    @model_validator(mode="after")
    def _both_of_tls(self) -> Settings:
        if (self.tls_cert is None) != (self.tls_key is None):
            raise ValueError("https needs both: tls_cert and tls_key")
        return self

    @field_validator("allowed_hosts", "allowed_ports", mode="before")
    @classmethod
    def _split(cls, value: object, info: ValidationInfo) -> object:
        if isinstance(value, str):
            parts = (part.strip() for part in value.split(",") if part.strip())
            return tuple(part.casefold() if info.field_name == "allowed_hosts" else part for part in parts)
        return value
