"""What the compose file says about its services, with variables filled in as an engine would."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

VARIABLE = re.compile(r"\$\{(\w+)(?::-([^${}]*))?\}")
NAMED = "data", "database"
"""The volumes of the file that are no folders beside it."""


@dataclass(frozen=True)
class Service:
    """A service: what is started, with which variables, and what is mounted where."""

    name: str
    command: list[str]
    environment: dict[str, str]
    volumes: list[tuple[str, str, bool]]
    """Source, a folder or the name of a volume; target; whether it is read-only."""
    tmpfs: list[tuple[str, str]]
    """Target, and options of the mount."""
    check: list[str]
    """The command of the health check."""


def services(file: Path, variables: Mapping[str, str]) -> dict[str, Service]:
    """All services of the file; the folders of their volumes are relative to it."""
    document = yaml.safe_load(file.read_text(encoding="utf-8"))
    return {name: _service(name, filled(given, variables)) for name, given in document["services"].items()}


def filled(value: Any, variables: Mapping[str, str]) -> Any:
    """A value with all variables replaced; an inner default first."""
    if isinstance(value, dict):
        return {key: filled(each, variables) for key, each in value.items()}
    if isinstance(value, list):
        return [filled(each, variables) for each in value]
    while isinstance(value, str) and VARIABLE.search(value):
        value = VARIABLE.sub(lambda found: variables.get(found[1]) or found[2] or "", value)
    return value


def _service(name: str, given: dict[str, Any]) -> Service:
    refused = {"privileged", "cap_add", "network_mode", "pid", "ipc", "devices"} & set(given)
    confined = (given["read_only"], given["cap_drop"], given["security_opt"], given["init"])
    if refused or confined != (True, ["ALL"], ["no-new-privileges:true"], True):
        raise ValueError(f"the service {name} is not confined: {refused or confined}")
    return Service(
        name,
        given.get("command", []),
        given.get("environment", {}),
        [_volume(each) for each in given["volumes"]],
        [(each.partition(":")[0], each.partition(":")[2]) for each in given.get("tmpfs", [])],
        given["healthcheck"]["test"][1:],
    )


def _volume(text: str) -> tuple[str, str, bool]:
    source, target, *mode = text.split(":")
    return source, target, mode == ["ro"]
