"""The service's settings, from environment variables `CLEARANCE_*`."""

from __future__ import annotations

import difflib
import ipaddress
import os
import re
import urllib.parse
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, SecretStr, ValidationError, model_validator

from backend import secret_settings
from backend.db import space
from backend.db.engine import default_url
from backend.provider.configuration import Configured, default_of, is_loopback, roles_of, safe_address
from backend.webhooks import configuration as hooked

PREFIX = "CLEARANCE_"
_OTHERS = frozenset(
    PREFIX + name
    for name in (
        "CAPSULE_CODE", "CHILD_MEMORY", "COMMAND", "COMPONENTS", "DESCRIBING", "EVALUATOR", "EXAMINATION_TIMEOUT",
        "FMU", "FUNCTION", "KERNEL_CACHE", "RETENTION_AGE", "RETENTION_SIZE", "SERVICE",
        "SIMULATORS", "SLOT", "THREADS", "TOKEN",
    )
)  # fmt: skip
"""Variables of workers, simulators and the command line."""
CLONE = Path(__file__).parent.parent


def built_pages() -> Path:
    """The folder of the built pages: of the clone that this file is in, else of the installed wheel."""
    from importlib.metadata import PackageNotFoundError, files

    clone = CLONE / "frontend" / "dist"
    if clone.is_dir() or (CLONE / "pyproject.toml").is_file():
        return clone
    try:
        listed = files("clearance") or []
    except PackageNotFoundError:
        listed = []
    installed = (Path(str(f.locate())) for f in listed if f.as_posix().endswith("share/clearance/pages/index.html"))
    return next((file.resolve().parent for file in installed), clone)


_PATH = re.compile(r"(/[A-Za-z0-9_~-][A-Za-z0-9._~-]*)*")


class Settings(BaseModel):
    """Where the service listens and stores its data; the environment variable is the name in capitals."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    data: Path = Path("data")
    """Folder for the database, the logs and the service's address; only its owner may read it."""
    database: str = ""
    """`sqlite:///FILE` or `postgresql://...`; empty: clearance.sqlite3 in the data folder."""
    database_password: SecretStr = SecretStr("")
    """The password of a PostgreSQL URL without one."""
    host: str = "127.0.0.1"
    port: Annotated[int, Field(ge=0, le=65535)] = 8000
    """0 selects a free port."""
    allow_any_host: bool = False
    """Permits a bind beyond loopback, for use inside a container that publishes on 127.0.0.1 only."""
    public_url: str = ""
    """The public address of the service, if it differs from host and port; it may have a path, such as /clearance."""
    allowed_hosts: str = ""
    """Further names by which browsers may call the service, separated by spaces; `*` allows every name."""
    trusted_proxies: str = ""
    """Addresses and networks, separated by spaces, whose X-Forwarded-For, -Proto and -Host are believed."""
    oidc_issuer: str = ""
    """The issuer of an OpenID Connect provider; empty: none."""
    oidc_client_id: str = ""
    oidc_client_secret: SecretStr = SecretStr("")
    oidc_name: Annotated[str, Field(max_length=40)] = "single sign-on"
    """What the sign-in page calls the provider."""
    oidc_scopes: str = "openid profile email"
    oidc_groups_claim: str = "groups"
    oidc_roles: str = ""
    """A JSON object of groups and roles."""
    oidc_default_role: str = ""
    """The role of users of whom no group has one; empty: they are refused."""
    print_link: bool = True
    """Whether a login link is printed on standard output at start."""
    pages: Path = Field(default_factory=built_pages)
    """The built front end."""
    browser_sandbox: bool = True
    """Whether Chromium makes its own sandbox to print a report; containers forbid it."""
    max_viewers: Annotated[int, Field(ge=0, le=1000)] = 32
    """Maximum number of open 3D views."""
    max_viewers_each: Annotated[int, Field(ge=1, le=1000)] = 6
    """Maximum number of open 3D views of one user, sessions and tokens together."""
    max_streams_each: Annotated[int, Field(ge=1, le=1000)] = 32
    """Maximum number of open event streams of one user; of one session or token four fifths of it."""
    max_requests_each: Annotated[int, Field(ge=1, le=100_000)] = 100
    """Maximum number of concurrent requests, streams and 3D views of one user; of one session or token four fifths."""
    max_requests_per_minute: Annotated[int, Field(ge=60, le=10_000_000)] = 6000
    """Maximum number of requests of one user in a minute, above which the rate is limited to that; of one session or
    token four fifths of it."""
    max_active_runs_each: Annotated[int, Field(ge=1, le=10_000_000)] = 2000
    """Maximum number of queued and running runs of one user, tokens included."""
    max_evaluations_each: Annotated[int, Field(ge=1)] = 500_000_000
    """Maximum number of stored evaluations of all runs of one user, tokens included."""
    max_bytes_each: Annotated[int, Field(ge=1)] = 100_000_000_000
    """Maximum size of what all runs of one user store, tokens included [bytes]."""
    min_free: Annotated[int, Field(ge=0)] = space.MIN_FREE
    """Free space at the database and the data folder below which no new run begins [bytes]; workers read it, too."""
    metrics_open: bool = False
    """Whether /metrics needs no token."""
    log: Literal["text", "json"] = "text"
    """Form of the log; workers read it, too."""
    max_connections: Annotated[int, Field(ge=1, le=100_000)] = 300
    """Maximum number of open connections; on further ones only the health check is answered."""
    max_connections_each: Annotated[int, Field(ge=1, le=100_000)] = 128
    """Maximum number of open connections of one address, and of concurrent requests of one behind a trusted proxy."""
    request_patience: Annotated[float, Field(gt=0, le=3600)] = 20.0
    """How long a client may take to send a request, and to read on while an answer is sent [s]."""
    access_log: bool = False
    """Whether the log has a line for every request."""
    webhooks: SecretStr = SecretStr("")
    """Addresses that receive a message when a run ends, separated by spaces; secret: some contain a password."""
    webhook_secret: SecretStr = SecretStr("")
    """Signs the messages to them."""
    webhook_private: bool = False
    """Permits addresses in private networks, and HTTP without encryption."""

    @property
    def hooks(self) -> hooked.Configured:
        """The webhooks; raises `ValueError` if they are invalid."""
        secret = self.webhook_secret.get_secret_value()
        return hooked.configured(self.webhooks.get_secret_value(), secret, self.webhook_private)

    @property
    def root(self) -> str:
        """The path of the public address, without a slash at its end."""
        return urllib.parse.urlsplit(self.public_url).path.rstrip("/")

    @property
    def trusted(self) -> list[str]:
        """The trusted proxies; raises `ValueError` if one is no address and no network."""
        proxies = self.trusted_proxies.replace(",", " ").split()
        for one in proxies:
            try:
                ipaddress.ip_network(one)  # "*" would believe every client
            except ValueError as error:
                raise ValueError(
                    f"{PREFIX}TRUSTED_PROXIES must be addresses such as 10.0.0.1 or networks such as 10.0.0.0/8, "
                    f"given {one!r}: {error}"
                ) from None
        return proxies

    @property
    def oidc_name_shown(self) -> str:
        """What the sign-in page calls the provider; empty without one."""
        return self.oidc_name if self.oidc_issuer else ""

    @property
    def provider(self) -> Configured | None:
        """The sign-in provider; raises `ValueError` if its settings are invalid."""
        if not self.oidc_issuer:
            return None
        if not safe_address(self.oidc_issuer):
            raise ValueError(f"{PREFIX}OIDC_ISSUER must be an https:// address, given {self.oidc_issuer!r}")
        if not self.oidc_client_id or not self.public_url:
            raise ValueError(
                f"{PREFIX}OIDC_ISSUER also needs {PREFIX}OIDC_CLIENT_ID and {PREFIX}PUBLIC_URL, the address to which "
                "the provider returns"
            )
        if find_spec("authlib") is None or find_spec("joserfc") is None:
            raise ValueError(
                f"{PREFIX}OIDC_ISSUER needs packages that are not installed: pip install 'clearance[oidc]'"
            )
        if "openid" not in self.oidc_scopes.split():
            raise ValueError(f"{PREFIX}OIDC_SCOPES must contain openid, given {self.oidc_scopes!r}")
        return Configured(
            issuer=self.oidc_issuer,
            client_id=self.oidc_client_id,
            name=self.oidc_name,
            redirect=f"{self.public_url.rstrip('/')}/login/provider/return",
            secret=self.oidc_client_secret.get_secret_value(),
            scopes=" ".join(self.oidc_scopes.split()),
            groups_claim=self.oidc_groups_claim,
            roles=roles_of(self.oidc_roles),
            default_role=default_of(self.oidc_default_role),
        )

    @model_validator(mode="after")
    def _public(self) -> Settings:
        parsed = urllib.parse.urlsplit(self.public_url)
        if self.public_url and (
            parsed.scheme not in ("http", "https") or not parsed.netloc or parsed.query or parsed.fragment
        ):
            raise ValueError(f"{PREFIX}PUBLIC_URL must be like https://host/path, given {self.public_url!r}")
        if not _PATH.fullmatch(self.root):
            raise ValueError(
                f"the path of {PREFIX}PUBLIC_URL may have letters, digits and - . _ ~ between single slashes, "
                f"given {self.root!r}"
            )
        _ = self.trusted, self.provider, self.hooks, self.database_url
        return self

    @model_validator(mode="after")
    def _loopback(self) -> Settings:
        if not self.allow_any_host and not is_loopback(self.host):
            raise ValueError(
                f"refusing to listen on {self.host!r}: only the loopback address is allowed, because the service does "
                f"not encrypt passwords and cookies; set {PREFIX}ALLOW_ANY_HOST=true behind a proxy with TLS, or where "
                f"the port is published on loopback only, as the compose file does"
            )
        return self

    @classmethod
    def load(cls, environment: Mapping[str, str] | None = None) -> Settings:
        """Settings from the environment. Raises `ValueError` with one line for each error."""
        names = {PREFIX + name.upper(): name for name in cls.model_fields}
        variables = secret_settings.read(cls.secret(), os.environ if environment is None else environment)
        try:
            return cls.model_validate({names[key]: value for key, value in variables.items() if key in names and value})
        except ValidationError as error:
            lines = (_line(e) for e in error.errors(include_url=False))
            raise ValueError("\n".join(lines)) from None

    @classmethod
    def secret(cls) -> list[str]:
        """The variables that may come from a file: all secrets, and the database, whose URL may have a password."""
        fields = cls.model_fields.items()
        return [PREFIX + name.upper() for name, f in fields if f.annotation is SecretStr or name == "database"]

    @classmethod
    def unknown(cls, environment: Mapping[str, str]) -> list[str]:
        """A sentence for each variable that looks like a setting but is not one: a misspelled setting has no effect."""
        names = [PREFIX + name.upper() for name in cls.model_fields]
        names += [name + secret_settings.FILE for name in cls.secret()]
        found = sorted(key for key in environment if key.startswith(PREFIX) and key not in {*names, *_OTHERS})
        near = [(key, difflib.get_close_matches(key, [*names, *sorted(_OTHERS)], 1, 0.85)) for key in found]
        return [f"{key} is not a setting and has no effect{f': is {n[0]} meant?' if n else ''}" for key, n in near]

    @property
    def database_url(self) -> str:
        """The database, with the password and the default filled in."""
        explicit_url = secret_settings.with_password(self.database, self.database_password.get_secret_value())
        return explicit_url or default_url(self.data)

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
        host = self.host if is_loopback(self.host) else "127.0.0.1"
        return self.public_url.rstrip("/") or f"http://{f'[{host}]' if ':' in host else host}:{port}"


def _line(error: object) -> str:
    assert isinstance(error, dict)
    message = str(error["msg"]).removeprefix("Value error, ")
    if not error["loc"]:
        return message
    return f"{PREFIX}{str(error['loc'][0]).upper()}: {message}, given {error['input']!r}"
