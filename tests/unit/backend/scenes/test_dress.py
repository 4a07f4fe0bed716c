"""viser's page in our dress: the tokens of the pages, handled rejections, and the order of its head."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import viser

from backend.scenes.base.dress import AT_REST, CHARSET, QUIET, SIZES, TOKENS, dressed, font_file, font_inside, style

TOKENS_CSS = Path(__file__).parents[4] / "frontend" / "src" / "theme" / "tokens.css"
VISER = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_text(encoding="utf-8")


def tokens(theme: str) -> dict[str, str]:
    block = re.search(
        rf':root\[data-theme="{theme}"\] \{{(.*?)\n\}}', TOKENS_CSS.read_text(encoding="utf-8"), re.DOTALL
    )
    assert block is not None
    return dict(re.findall(r"--([\w-]+): (.*?);", block[1]))


def test_the_frames_without_a_request_are_those_of_the_script() -> None:
    """AT_REST knows them by their interval, which nothing else on viser's page has while it is connected."""
    source = (Path(viser.__file__).parent / "client" / "src" / "App.tsx").read_text(encoding="utf-8")
    assert "const RENDER_HEARTBEAT_MS = 1000;" in source
    assert "setInterval(() => invalidate(), RENDER_HEARTBEAT_MS)" in source
    assert source.count("setInterval(") == 1
    assert 'frameloop="demand"' in source


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_tokens_are_those_of_the_pages(theme: str) -> None:
    named = tokens(theme)
    assert TOKENS[theme] == {name: named[name] for name in TOKENS[theme]}


def test_the_sizes_are_those_of_the_pages() -> None:
    text = TOKENS_CSS.read_text(encoding="utf-8")
    ours = [re.search(rf"--t-{name}: (\d+px)", text) for name in ("micro", "small", "body", "h2", "h1")]
    assert [size[1] for size in ours if size] == list(SIZES.values())


def test_a_page_begins_with_its_character_set_and_has_the_style_once() -> None:
    page = dressed(VISER, "data:font/woff2;base64,AAAA")
    assert page.index(CHARSET) < 200, "a file from disk has no other description of its characters"
    assert page.count(QUIET) == page.count(AT_REST) == page.count("@font-face{font-family:'Inter Variable'") == 1
    assert page.index(CHARSET) < page.index(QUIET) < page.index("<script data-p=")
    assert "@font-face" not in style(None)


def test_the_font_is_that_of_the_built_pages(tmp_path: Path) -> None:
    assert (font_file(tmp_path), font_inside(tmp_path)) == (None, None)
    built = tmp_path / "built" / "assets"
    built.mkdir(parents=True)
    (built / "inter-latin-wght-normal-Dx4kXJAl.woff2").write_bytes(b"wOF2")
    assert font_inside(built.parent) == "data:font/woff2;base64,d09GMg=="
