"""What is read, stored or sent as JSON and has no type of its own. Start reading at `JsonObject`."""

from __future__ import annotations

from typing import Any

JsonObject = dict[str, Any]
"""A JSON object at an edge: a document as given, a column, a message, a part of an OpenAPI description."""
