"""Serves the built single-page application with deep links, and a few plain pages.

Hashed assets are cached by browsers for a year; the page that names them is requested each time (RFC 9111).
"""

from __future__ import annotations

import html
import mimetypes
import re
from pathlib import Path

from fastapi import FastAPI, Request
from fastapi.responses import FileResponse, HTMLResponse, RedirectResponse, Response
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException

from backend.http.root import at

INDEX = "index.html"
ASSET = {"Cache-Control": "public, max-age=31536000, immutable"}
FRESH = {"Cache-Control": "no-cache"}
FONTS = {
    "assets/inter.woff2": "inter-latin-wght-normal-*.woff2",
    "assets/mono.woff2": "jetbrains-mono-latin-wght-normal-*.woff2",
}
"""Addresses of the built fonts for the plain pages, whose names contain hashes."""
_STYLE = (
    '@font-face{font-family:Inter;src:url(ROOT/assets/inter.woff2) format("woff2");'
    "font-weight:100 900;font-display:swap}"
    '@font-face{font-family:Mono;src:url(ROOT/assets/mono.woff2) format("woff2");'
    "font-weight:100 800;font-display:swap}"
    "*{box-sizing:border-box}"
    "body{font:14px/22px Inter,system-ui,sans-serif;margin:0;padding:12vh 20px 48px;color:#15202b;background:#f6f7f9}"
    "main{max-width:31em;margin:0 auto;padding:28px 32px;background:#fff;border:1px solid #e2e6eb;border-radius:8px}"
    "header{display:flex;align-items:center;gap:9px;margin-bottom:24px;font-weight:600}"
    "h1{font-size:20px;line-height:28px;margin:0 0 8px}p{margin:0 0 12px;color:#435061}p:last-child{margin:0}"
    "code{font:12.5px Mono,ui-monospace,monospace;color:#15202b;background:#f1f3f6;padding:2px 5px;"
    "border-radius:4px;white-space:nowrap}"
    "form{display:grid;gap:4px;margin:0 0 20px}label{font-weight:500;margin-top:8px}"
    "input{font:inherit;color:inherit;background:#fff;border:1px solid #7b8794;border-radius:6px;padding:7px 10px}"
    "button{font:inherit;font-weight:600;color:#fff;background:#15202b;border:0;border-radius:6px;padding:9px 14px;"
    "margin-top:14px;cursor:pointer}.button{display:block;text-align:center;font-weight:600;color:#15202b;"
    "border:1px solid #7b8794;border-radius:6px;padding:8px 14px;margin:4px 0 8px;"
    "text-decoration:none}:is(input,button,a):focus-visible{outline:2px solid #0072b2;outline-offset:2px}"
    "a{color:#005a8f}b{color:#15202b}.wrong{color:#a3330a;font-weight:500}.or{margin:14px 0 4px;text-align:center}"
    "@media(max-width:600px){main{padding:20px}}"
    "@media(prefers-color-scheme:dark){body{color:#e7ecf2;background:#0d1115}"
    "main{background:#14191f;border-color:#28313a}p{color:#b0bbc7}code{color:#e7ecf2;background:#1a2027}"
    "input{background:#0d1115;border-color:#6b7783}button{color:#0d1115;background:#e7ecf2}a{color:#56b4e9}.button{color:#e7ecf2}"
    "b{color:#e7ecf2}.wrong{color:#ff9466}}"
)
_BRAND = (
    '<header><svg viewBox="0 0 24 24" width="22" height="22" fill="none" aria-hidden="true">'
    '<circle cx="13.5" cy="10.5" r="6.2" stroke="currentColor" stroke-width="1.6" stroke-dasharray="2.6 2.1"/>'
    '<circle cx="13.5" cy="10.5" r="2.1" fill="currentColor"/>'
    '<path d="M2 20.5c6 .6 14.5-.2 19.5-5.5" stroke="#d55e00" stroke-width="2" stroke-linecap="round"/></svg>'
    "Clearance</header>"
)
"""The mark and the name, as in the header of the other pages."""


def serve(app: FastAPI, folder: Path) -> None:
    """Serve all addresses outside the API from the built front end; call it after all other routes."""

    @app.get("/", include_in_schema=False)
    def start() -> Response:
        return _not_built(folder) if unbuilt(folder) else RedirectResponse(at("/runs"), 307)

    @app.api_route("/{path:path}", methods=["GET", "HEAD"], include_in_schema=False)
    def page(path: str, request: Request) -> Response:
        if path.startswith("api/"):
            raise HTTPException(404)
        file = _inside(folder, path)
        font = next((folder / "assets").glob(FONTS[path]), None) if path in FONTS else None
        if font is not None:
            return FileResponse(font, headers=FRESH)
        if file is not None:
            return _asset(file, request.headers) if path.startswith("assets/") else FileResponse(file, headers=FRESH)
        if path.startswith("assets/") or not wants_page(request.headers):
            raise HTTPException(404)
        return _not_built(folder) if unbuilt(folder) else _index(folder / INDEX, at(""))


def unbuilt(folder: Path) -> str:
    """Why there are no pages, and what to do, as one sentence; empty if there are."""
    if (folder / INDEX).is_file():
        return ""
    return (
        f"there are no built pages in {folder}, only the API: install the wheel that `make wheel` builds in a clone of "
        "Clearance, or set CLEARANCE_PAGES to the folder frontend/dist of a clone after `make install`"
    )


def _not_built(folder: Path) -> HTMLResponse:
    sentence = html.escape(unbuilt(folder))
    sentence = re.sub("`(.+?)`|(CLEARANCE_PAGES|frontend/dist)", r"<code>\1\2</code>", sentence)
    return plain("The pages are not built", f"<p>{sentence[:1].upper()}{sentence[1:]}.</p>", 503)


def _index(index: Path, root: str) -> Response:
    """The page of the application, with its files below the path of the public address; scripts read `data-root`."""
    text = index.read_text(encoding="utf-8")
    if root:
        text = text.replace("<html ", f'<html data-root="{root}" ', 1)
    text = re.sub(r'\b(src|href)="(?:\./|/)', rf'\1="{root}/', text)
    return HTMLResponse(text, headers=FRESH)


def _asset(file: Path, headers: Headers) -> Response:
    """A hashed file, precompressed (RFC 7932) if the browser accepts that."""
    packed = file.with_name(f"{file.name}.br")
    if not packed.is_file():
        return FileResponse(file, headers=ASSET)
    answer_headers = ASSET | {"Vary": "Accept-Encoding"}
    if "br" not in {coding.partition(";")[0].strip() for coding in headers.get("accept-encoding", "").split(",")}:
        return FileResponse(file, headers=answer_headers)
    kind = mimetypes.guess_type(file.name)[0]
    return FileResponse(packed, media_type=kind, headers=answer_headers | {"Content-Encoding": "br"})


def _inside(folder: Path, path: str) -> Path | None:
    if "\0" in path:
        return None
    root = folder.resolve()
    try:
        file = (root / path).resolve()
        return file if file.is_relative_to(root) and file.is_file() and file.name != INDEX else None
    except OSError:  # an invalid file name, such as one of more than 255 bytes
        return None


def wants_page(headers: Headers) -> bool:
    """Whether the request is a browser navigation, not a call by a program or script."""
    return "text/html" in headers.get("accept", "")


def plain(title: str, body: str, status: int) -> HTMLResponse:
    """A short page; `body` is HTML."""
    style = _STYLE.replace("ROOT", at(""))
    text = (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)} · Clearance</title>'
        f'<meta name="viewport" content="width=device-width"><style>{style}</style></head>'
        f"<body><main>{_BRAND}<h1>{html.escape(title)}</h1>{body}</main></body></html>"
    )
    return HTMLResponse(text, status)
