"""The service's settings, from environment variables `CLEARANCE_*`. Start reading at `Settings.load`."""

from __future__ import annotations

import ipaddress
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, SecretStr, ValidationError, model_validator

from backend.db.engine import default_url
from backend.webhooks.configured import Configured, configured

PREFIX = "CLEARANCE_"


class Settings(BaseModel):
    """Where the service listens and stores its data; the environment variable is the name in capitals."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    data: Path = Path("data")
    """Folder for the database, the logs and the service's address; only its owner may read it."""
    database: str = ""
    """`sqlite:///FILE` or `postgresql://...`; empty: clearance.sqlite3 in the data folder."""
    host: str = "127.0.0.1"
    port: Annotated[int, Field(ge=0, le=65535)] = 8000
    """0 selects a free port."""
    allow_any_host: bool = False
    """Permits a bind beyond loopback, for use inside a container that publishes on 127.0.0.1 only."""
    public_url: str = ""
    """The public address of the service, if it differs from host and port."""
    allowed_hosts: str = ""
    """Further names by which browsers may call the service, separated by spaces; `*` allows every name."""
    print_link: bool = True
    """Whether a login link is printed on standard output at start."""
    pages: Path = Path(__file__).parent.parent / "frontend" / "dist"
    """The built front end."""
    max_viewers: Annotated[int, Field(ge=0, le=1000)] = 32
    """Maximum number of open 3D views."""
    max_viewers_each: Annotated[int, Field(ge=1, le=1000)] = 6
    """Maximum number of open 3D views of one session or token."""
    max_requests_each: Annotated[int, Field(ge=1, le=100_000)] = 100
    """Maximum number of concurrent requests, streams and 3D views of one session or token."""
    max_requests_per_minute: Annotated[int, Field(ge=60, le=10_000_000)] = 6000
    """Maximum number of requests of one session or token in a minute; above it the rate is limited to that."""
    max_active_runs_each: Annotated[int, Field(ge=1, le=10_000_000)] = 2000
    """Maximum number of queued and running runs of one user, tokens included."""
    max_evaluations_each: Annotated[int, Field(ge=1)] = 500_000_000
    """Maximum number of stored evaluations of all runs of one user, tokens included."""
    max_connections: Annotated[int, Field(ge=1, le=100_000)] = 300
    """Maximum number of open connections; further ones are refused."""
    request_patience: Annotated[float, Field(gt=0, le=3600)] = 20.0
    """How long a client may take to send a request, and to read on while an answer is sent [s]."""
    webhooks: SecretStr = SecretStr("")
    """Addresses that receive a message when a run ends, separated by spaces; secret: some contain a password."""
    webhook_secret: SecretStr = SecretStr("")
    """Signs the messages to them."""
    webhook_private: bool = False
    """Permits addresses in private networks, and HTTP without encryption."""

    @property
    def hooks(self) -> Configured:
        """The webhooks; raises `ValueError` if they are invalid."""
        secret = self.webhook_secret.get_secret_value()
        return configured(self.webhooks.get_secret_value(), secret, self.webhook_private)

    @model_validator(mode="after")
    def _hooked(self) -> Settings:
        _ = self.hooks
        return self

    @model_validator(mode="after")
    def _loopback(self) -> Settings:
        if not self.allow_any_host and not _is_loopback(self.host):
            raise ValueError(
                f"refusing to listen on {self.host!r}: only the loopback address is allowed, because the service does "
                f"not encrypt passwords and cookies; set {PREFIX}ALLOW_ANY_HOST=true behind a proxy with TLS, or where "
                f"the port is published on loopback only, as the compose file does"
            )
        return self

    @classmethod
    def load(cls, environment: Mapping[str, str] | None = None) -> Settings:
        """Settings from the environment. Raises `ValueError` with one line for each error."""
        given = os.environ if environment is None else environment
        names = {PREFIX + name.upper(): name for name in cls.model_fields}
        try:
            return cls.model_validate({names[key]: value for key, value in given.items() if key in names and value})
        except ValidationError as error:
            lines = (_line(e) for e in error.errors(include_url=False))
            raise ValueError("\n".join(lines)) from None

    @property
    def database_url(self) -> str:
        """The database, with the default filled in."""
        return self.database or default_url(self.data)

    @property
    def encrypted(self) -> bool:
        """Whether browsers reach the service by HTTPS only, by its public address."""
        return self.public_url.lower().startswith("https://")

    @property
    def cookie(self) -> str:
        """The session cookie's name; browsers share cookies among the ports of a host, so the port is part of it."""
        return f"clearance_{self.port}"

    def url(self, port: int) -> str:
        """The service's address for a browser on this machine."""
        host = self.host if _is_loopback(self.host) else "127.0.0.1"
        return self.public_url.rstrip("/") or f"http://{f'[{host}]' if ':' in host else host}:{port}"


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _line(error: object) -> str:
    assert isinstance(error, dict)
    message = str(error["msg"]).removeprefix("Value error, ")
    if not error["loc"]:
        return message
    return f"{PREFIX}{str(error['loc'][0]).upper()}: {message}, given {error['input']!r}"
