"""The type of JSON data without a type of its own, and its canonical form."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

JsonObject = dict[str, Any]
"""A JSON object at a boundary: an input document, a column, a message, a part of an OpenAPI description."""


def canonical(document: Mapping[str, Any]) -> str:
    """A document as JSON in one form: with sorted keys and without spaces."""
    return json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)


def digest_of(document: Mapping[str, Any]) -> str:
    """SHA-256 over the canonical form, 64 hexadecimal digits."""
    return hashlib.sha256(canonical(document).encode()).hexdigest()
