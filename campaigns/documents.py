"""The type of JSON data without a type of its own."""

from __future__ import annotations

from typing import Any

JsonObject = dict[str, Any]
"""A JSON object at a boundary: an input document, a column, a message, a part of an OpenAPI description."""
