"""Who signed in through the provider."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Identity:
    issuer: str
    subject: str
    name: str
    """What the provider calls the user; a wish only, never an identification."""
    groups: tuple[str, ...]
