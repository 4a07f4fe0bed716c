"""The isolation of viser's pages: a document of its own, opaque origin, which has no session and may only run scripts.

Stated by the response itself, so that it holds in a frame and in a window alike. Source: HTML, 7.1.5, sandboxing.
"""

from __future__ import annotations

SANDBOX = "sandbox allow-scripts"
"""A directive of the content security policy."""

OPENED_ALONE = {"Cross-Origin-Opener-Policy": "unsafe-none"}
"""A window whose document is sandboxed is not shown with another policy (HTML, 7.4.5, navigation)."""
