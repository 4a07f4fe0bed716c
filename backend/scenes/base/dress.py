"""viser's page in the dress of our pages: fonts, sizes and colours of the panel, and no uncaught error.

The tokens are those of `frontend/src/theme/tokens.css`; a test compares both.
"""

from __future__ import annotations

import base64
from functools import cache
from pathlib import Path

FAMILY = '"Inter Variable",system-ui,"Segoe UI",Roboto,sans-serif'
MONO = '"JetBrains Mono Variable",ui-monospace,Menlo,monospace'
TOKENS = {
    "light": {
        "surface": "#fff", "sunken": "#f1f3f6", "hover": "#f4f6f8", "line": "#e2e6eb", "line-2": "#c8d0d9",
        "ink": "#15202b", "ink-2": "#435061", "ink-3": "#5d6a7b", "focus": "#0a6ccf",
    },
    "dark": {
        "surface": "#14191f", "sunken": "#1a2027", "hover": "#1a2128", "line": "#28313a", "line-2": "#3b4753",
        "ink": "#e7ecf2", "ink-2": "#b0bbc7", "ink-3": "#8f9cab", "focus": "#5aa9f5",
    },
}  # fmt: skip
"""The colours of the panel by theme."""
SIZES = {"xs": "11px", "sm": "12px", "md": "13px", "lg": "15px", "xl": "20px"}
"""Micro, small, body and headings of our pages, by viser's names."""
_BODY = "font-family:var(--mantine-font-family);font-size:var(--mantine-font-size-md);font-feature-settings:'tnum'"
"""viser gives its body a family of its own."""
LATIN = "inter-latin-wght-normal-*.woff2"
"""The font file of the built pages with the letters that the panel has."""

QUIET = (
    "<script>addEventListener('unhandledrejection',e=>{if(e.reason instanceof EvalError)e.preventDefault()})</script>"
)
"""At its start viser prepares to sort Gaussian splats by compiling code from text, which the policy refuses; no scene
has splats. The rejection is handled, so that the policy stays strict and the console empty."""

BEATS = 3
"""How many of viser's frames without a request, one a second, are drawn after something happened."""

AT_REST = """<script>
{let left=BEATS;const stir=()=>{left=BEATS},watched=new WeakSet(),{setInterval:every}=window;
for(const kind of ['pointerdown','pointermove','wheel','keydown','resize','focus','visibilitychange'])
addEventListener(kind,stir,{capture:true,passive:true});
const post=Worker.prototype.postMessage;
Worker.prototype.postMessage=function(...sent){
if(!watched.has(this)){watched.add(this);this.addEventListener('message',stir)}
return post.apply(this,sent)};
window.setInterval=(work,wait,...more)=>every(
wait===1000?()=>{if(left>0&&!document.hidden){left--;work(...more)}}:work,wait,...more);
const contexts=new Set(),get=HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext=function(...wanted){
const context=get.apply(this,wanted);
if(context&&/^webgl/.test(wanted[0]))contexts.add(context);
return context};
addEventListener('pagehide',event=>{if(!event.persisted)
for(const context of contexts)context.getExtension('WEBGL_lose_context')?.loseContext()})}
</script>""".replace("BEATS", str(BEATS))
"""viser draws on request, and once a second for changes that forget to request it: a seventh of a core where the
processor draws. At rest nothing changes, so that these frames end soon after the last message or movement. A page that
is left frees its graphics at once."""

CHARSET = '<meta charset="utf-8" />'
"""It must be at the beginning of a file, which no header describes."""


def dressed(page: str, font: str | None) -> str:
    """viser's page with our style. font: the address of the font file."""
    return page.replace(CHARSET, f"{CHARSET}{QUIET}{AT_REST}<style>{style(font)}</style>", 1)


@cache
def font_file(pages: Path) -> Path | None:
    return next(iter(sorted((pages / "assets").glob(LATIN))), None)


@cache
def font_inside(pages: Path) -> str | None:
    """The font as a data address, for a file that works offline."""
    file = font_file(pages)
    if file is None:
        return None
    return f"data:font/woff2;base64,{base64.b64encode(file.read_bytes()).decode()}"


def style(font: str | None) -> str:
    """The style sheet. Custom properties are important, because viser sets its own later."""
    common = {
        "mantine-font-family": FAMILY,
        "mantine-font-family-headings": FAMILY,
        "mantine-font-family-monospace": MONO,
        "mantine-line-height": "1.45",
        "mantine-radius-default": "6px",
        **{f"mantine-font-size-{name}": size for name, size in SIZES.items()},
    }
    themes = (
        f":root[data-mantine-color-scheme={theme}]{{{_properties(_colours(named))}}}" for theme, named in TOKENS.items()
    )
    face = _face(font) if font else ""
    return f"{face}:root{{{_properties(common)}}}{''.join(themes)}:root body{{{_BODY}}}"


def _face(font: str) -> str:
    about = "font-family:'Inter Variable';font-weight:100 900;font-display:swap"
    return f"@font-face{{{about};src:url({font}) format('woff2')}}"


def _colours(tokens: dict[str, str]) -> dict[str, str]:
    return {
        "mantine-color-body": tokens["surface"],
        "mantine-color-text": tokens["ink"],
        "mantine-color-bright": tokens["ink"],
        "mantine-color-dimmed": tokens["ink-3"],
        "mantine-color-placeholder": tokens["ink-3"],
        "mantine-color-default": tokens["surface"],
        "mantine-color-default-hover": tokens["hover"],
        "mantine-color-default-color": tokens["ink"],
        "mantine-color-default-border": tokens["line-2"],
    }


def _properties(values: dict[str, str]) -> str:
    return "".join(f"--{name}:{value}!important;" for name, value in values.items())


SANDBOX = "sandbox allow-scripts"
"""A directive of the content security policy."""

OPENED_ALONE = {"Cross-Origin-Opener-Policy": "unsafe-none"}
"""A window whose document is sandboxed is not shown with another policy (HTML, 7.4.5, navigation)."""
