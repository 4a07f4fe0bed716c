"""The 3D view: its page at /view/R-0001/ and the socket behind it."""

from __future__ import annotations

import contextlib
import gzip
import logging
from functools import cache
from pathlib import Path

import viser
from fastapi import APIRouter, Request, WebSocket
from fastapi.responses import RedirectResponse, Response
from starlette.websockets import WebSocketDisconnect

from backend.db.engine import read
from backend.http.deps import Reader
from backend.http.errors import RefusedError
from backend.http.root import at
from backend.runs.service import number
from backend.scenes.base import setting
from backend.scenes.base.address import Address, parse
from backend.scenes.base.dress import OPENED_ALONE, SANDBOX, dressed, font_inside
from backend.scenes.base.progress import Progress
from backend.scenes.control.relay import relay
from backend.scenes.control.viewers import Handle, Viewers
from backend.scenes.viewer.viewer import Viewer

router = APIRouter(include_in_schema=False)

_MOVES = """<script>
{const shown=location.pathname+location.hash.slice(1),say=Worker.prototype.postMessage;
Worker.prototype.postMessage=function(message,...more){
if(message?.type==='set_server')message={...message,server:location.origin.replace('http','ws')+shown};
return say.call(this,message,...more)};
const made=URL.createObjectURL;
URL.createObjectURL=one=>one.type==='text/javascript;charset=utf-8'?'':made.call(URL,one);
if(self===top&&!shown.includes('/key/')){
const q=new URLSearchParams(),[,run,...rest]=shown.slice('ROOT'.length).split('/').filter(Boolean);
for(let i=0;i<rest.length;i++){const w=rest[i];
if(w==='t'||w==='cam')q.set(w,rest[++i]);else if(w!=='dark'&&w!=='light')q.set('finding',w)}
location.replace('ROOT/runs/'+run+'/flight'+(q.size?'?'+q:''))}}
</script>"""
"""The fragment (after #) is moved into the path of the socket: a browser caches one page for all views of a run. viser
derives the socket's address from the page's, which a sandboxed page may not change; its worker gets another.
Chromium starts no module worker from a blob of a sandboxed page: without an address of one, viser takes a `data:` one.

A view in its own window, without a key, has no controls: it redirects to the page that has them.
"""
_DOCKS = """<script>
{const ask=matchMedia.bind(window);window.matchMedia=query=>ask(query==='(max-width: 36em)'?'not all':query)}
</script>"""
"""Keeps the panel docked in narrow windows. There viser would show it as a sheet over the scene, which always begins
unfolded and which no command folds.
"""
_PAGE = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_text(encoding="utf-8")
CSP = (
    "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval' blob: data:; worker-src blob: data:; "
    "style-src 'unsafe-inline'; img-src data: blob:; font-src data:; connect-src 'self' data: blob:; "
    f"base-uri 'none'; form-action 'none'; frame-ancestors 'self'; {SANDBOX}"
)
"""viser's page is one self-contained file. `connect-src 'self'` prevents it from connecting to another server."""

FAILED = 1011
BUSY = 1013
REFUSED = 1008
_log = logging.getLogger(__name__)


@router.get("/view/{run}")
def view_without_slash(run: str, request: Request) -> Response:
    """Redirect to the address with a slash: the page derives its socket's address from its own."""
    return RedirectResponse(at(f"{request.url.path}/"), 308)


@router.get("/view/{run}/{rest:path}")
def view_page(run: str, rest: str, request: Request, reader: Reader) -> Response:
    """The viewer's page; identical for every run, since the scene comes over the socket."""
    setting.drawable(reader, number(run))
    _address(rest)
    if "websocket" in request.query_params:
        detail = "?websocket= would connect this page to another server and is not allowed"
        raise RefusedError("not-allowed", detail)
    if "playbackPath" in request.query_params:
        raise RefusedError("not-allowed", "?playbackPath= is not allowed: recordings have their own addresses")
    plain, compressed = _page(request.app.state.settings.pages, at(""))
    packed = "gzip" in request.headers.get("accept-encoding", "")
    headers = {"Content-Security-Policy": CSP, "Vary": "Accept-Encoding", "Cache-Control": "private, max-age=3600"}
    headers |= OPENED_ALONE
    if packed:
        headers["Content-Encoding"] = "gzip"
    return Response(compressed if packed else plain, media_type="text/html", headers=headers)


@cache
def _page(pages: Path, root: str) -> tuple[bytes, bytes]:
    """The page, plain and compressed, with the font of the built pages, which it may not load."""
    page = _PAGE.replace("<head>", f"<head>{_MOVES.replace('ROOT', root)}{_DOCKS}", 1)
    plain = dressed(page, font_inside(pages)).encode()
    return plain, gzip.compress(plain, 9)


@router.websocket("/view/{run}")
async def view_socket_at_root(socket: WebSocket, run: str) -> None:
    """The socket of a page whose address ends with the run."""
    await view_socket(socket, run, "")


@router.websocket("/view/{run}/{rest:path}")
async def view_socket(socket: WebSocket, run: str, rest: str) -> None:
    """The socket of one viewer; the guard has checked the visitor and the Origin, or the key of a page's frame."""
    if socket.query_params or not socket.scope["subprotocols"]:
        await socket.close(REFUSED)
        return
    try:
        run_id, address = number(run), parse(rest)
    except (RefusedError, ValueError):
        await socket.close(REFUSED)
        return
    viewers: Viewers = socket.app.state.viewers
    visitor = socket.state.visitor
    if not viewers.enter(visitor):
        await socket.close(BUSY)
        return
    try:
        with contextlib.ExitStack() as offered:

            def opened(viewer: Viewer) -> None:
                if address.key is not None:
                    handle = Handle(visitor, run_id, address.key)
                    viewers.offer(handle, viewer)
                    offered.callback(viewers.withdraw, handle, viewer)

            await relay(socket, lambda server: _build(server, socket, run_id, address), opened, viewers)
    except RefusedError:
        await socket.close(REFUSED)
    except Exception:
        _log.exception("the 3D view of %s failed", run)
        with contextlib.suppress(RuntimeError, WebSocketDisconnect):
            await socket.close(FAILED)
    finally:
        viewers.leave(visitor)


def _address(rest: str) -> Address:
    try:
        return parse(rest)
    except ValueError as error:
        raise RefusedError(
            "not-found", f"{error}: /view/RUN/F2/t/SECONDS/cam/chase/dark/key/UUID, each part is optional"
        ) from None


def _build(server: viser.ViserServer, socket: WebSocket, run_id: int, address: Address) -> Viewer:
    state = socket.app.state
    with read(state.engine) as reader:
        fixed = setting.load(reader, run_id)
        progress = Progress(fixed, run_id, address.flight)
        progress.look(reader)
    # What a simulator evaluates on demand, it evaluates in a process of its own.
    live = state.live if fixed.clears else state.cases
    return Viewer(server, state.engine, live, fixed, progress, address)
