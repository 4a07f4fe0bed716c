"""What of the source files is code, and when this process no longer has what the files have."""

from __future__ import annotations

import ast
import importlib
import json
import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from campaigns import library, load_file
from campaigns.identity.code import code_of
from tests.given.case_campaigns import campaign, document
from tests.given.edited_code import digest_with
from worker.running.runs import identity, meaning, sources

MODULE = b'"""Text."""\nX = 1.0\n\n\ndef f(x):\n    """Help."""\n    return x * X\n'


def means_the_same(text: bytes, edit: tuple[bytes, bytes]) -> bool:
    """Whether a module has the same meaning after an edit."""
    assert edit[0] in text
    return meaning.meaning(text) == meaning.meaning(text.replace(*edit))


@pytest.fixture
def added(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package of others that adds components by an entry point."""
    package = tmp_path / "added_here"
    (package / "inner").mkdir(parents=True)
    for name in ("__init__", "post", "inner/helper"):
        (package / f"{name}.py").write_bytes(MODULE)
    info = tmp_path / "added_here-1.5.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: added-here\nVersion: 1.5\n", encoding="utf-8")
    (info / "entry_points.txt").write_text("[clearance.components]\npost = added_here.post\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()
    return package


@pytest.mark.parametrize(
    ("edit", "same"),
    [
        ((b"Text.", b"Another text."), True),
        ((b"Help.", b"Other help."), True),
        ((b"X = 1.0\n", b"X = 1.0  # a comment\n\n\n"), True),
        ((b"return x * X", b"return (x * X)"), True),
        ((b"X = 1.0", b"X = 1.5"), False),
        ((b"X = 1.0", b"X = 1"), False),
        ((b"x * X", b"X * x"), False),
        ((b"def f(x)", b"def f(x=2.0)"), False),
    ],
)
def test_code_is_what_can_change_a_number(edit: tuple[bytes, bytes], same: bool) -> None:
    assert means_the_same(MODULE, edit) == same


STOP = b"""from worker.engine.search.base import Ended
def end(n):
    return Ended("drawn", "drew {samples} samples", samples=n)
"""


@pytest.mark.parametrize(
    ("edit", "same"),
    [
        ((b"drew {samples} samples", b"{samples} samples were drawn"), True),
        ((b'"drawn"', b'"other"'), False),
        ((b"samples=n", b"samples=n + 1"), False),
        ((b"from worker.engine.search.base import Ended", b"Ended = print"), False),
    ],
)
def test_the_words_of_a_stop_rule_are_no_code(edit: tuple[bytes, bytes], same: bool) -> None:
    assert means_the_same(STOP, edit) == same


def test_the_text_of_another_function_of_that_name_is_code() -> None:
    own = STOP.replace(b"worker.engine.search.base", b"own.rules")
    assert meaning.meaning(own) != meaning.meaning(own.replace(b"drew", b"took"))


METHOD = b"""from pydantic import Field
from worker.engine.search.base import Method, MethodLook
steps: Annotated[int, Field(ge=1, description="Steps at most")] = 5
METHOD = Method(
    name="steps", title="Steps", kind="global", how="Global. Steps down", source="Own", evaluations=200, search=search,
    parallel="one point", suits="smooth criteria", drawback="Others reach 0.9",
    look=MethodLook(colour="#b97c00", marker="cross"),
)
"""


@pytest.mark.parametrize(
    ("edit", "same"),
    [
        ((b"Steps at most", b"Most steps"), True),
        ((b'"Steps"', b'"Descent"'), True),
        ((b"Global. Steps down", b"Descends"), True),
        ((b'"Own"', b'"Own 2012"'), True),
        ((b'"one point"', b'"a point"'), True),
        ((b"smooth criteria", b"criteria"), True),
        ((b"0.9", b"0.8"), True),
        ((b"#b97c00", b"#000000"), True),
        ((b'"cross"', b'"circle"'), True),
        ((b"ge=1", b"ge=2"), False),
        ((b'"steps"', b'"descent"'), False),
        ((b'"global"', b'"local"'), False),
        ((b"200", b"300"), False),
        ((b'how="Global. Steps down"', b"how=told()"), False),
        ((b"import Method, ", b"import Other as Method, "), False),
    ],
)
def test_what_a_method_shows_a_reader_is_no_code(edit: tuple[bytes, bytes], same: bool) -> None:
    assert means_the_same(METHOD, edit) == same


def test_meanings_by_another_rule_of_texts_are_stored_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    before = meaning._file()
    assert meaning._file() == before
    monkeypatch.setitem(meaning._TEXTS, ("own.rules", "Rule"), frozenset({"text"}))
    assert meaning._file() != before


EVERY = {
    "sensitivity": {"points": 3, "morris": {"trajectories": 4}, "sobol": {"samples": 8}},
    "search": [{"method": "direct", "evaluations": 10}, {"method": "monte_carlo", "evaluations": 10}],
    "certify": {"samples": 5, "grid": {"points": 2}},
}
WORDS = {
    "campaigns.claims.stages.ends": b"used its budget of",
    "campaigns.claims.stages.sample": b"none of the other ",
    "campaigns.claims.stages.calls": b"repeats bit by bit",
    "campaigns.claims.stages.surroundings": b"varying one parameter alone",
    "campaigns.claims.stages.earlier_run": b"was not evaluated",
    "worker.engine.search.methods.direct": b"completed the {iterations} iterations",
    "worker.engine.search.methods.monte_carlo": b"drew all {samples} samples",
    "worker.evidence.verdicts.sentence": b"Nothing may be claimed",
}
"""A sentence of a run in each of these modules."""


@pytest.fixture
def edited() -> Callable[[str, bytes, bytes], str]:
    """The code digest of a run of all stages with one text of one module replaced."""
    return partial(digest_with, campaign(stages=EVERY))


def test_no_word_of_a_run_is_part_of_its_code(edited: Callable[[str, bytes, bytes], str]) -> None:
    before = edited("worker", b"", b"")
    assert {module: edited(module, words, b"Other words") for module, words in WORDS.items()} == dict.fromkeys(
        WORDS, before
    )
    numbers = {
        "worker.engine.stages.parts.boundary": b"SAMPLES = 20",
        "worker.engine.stages.parts.claims": b"return 1.0",
        "worker.engine.search.methods.monte_carlo": b'"drawn"',
    }
    assert before not in {edited(module, text, text + b" + 1") for module, text in numbers.items()}


def test_the_stages_build_no_sentence() -> None:
    """They call `campaigns.claims.stages`; the end of a search is put together from its own sentence and numbers."""
    root = "worker.engine.stages"
    building = {name for name in sources.LOADED.files if name.startswith(root) and any(
        one.module == "campaigns.claims.say" and one.name == "say" for one in identity.loaded()[name].imports
    )}  # fmt: skip
    assert building == {f"{root}.parts.ended"}


def test_the_meaning_of_a_text_is_computed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CLEARANCE_KERNEL_CACHE", str(tmp_path))
    files = {"one": MODULE, "other": MODULE.replace(b"1.0", b"1.5"), "again": MODULE}
    expected = {name: meaning.meaning(content) for name, content in files.items()}
    assert meaning.meanings(files) == expected
    [file] = (tmp_path / "meanings").iterdir()
    parsed: list[bytes] = []
    parse = ast.parse
    monkeypatch.setattr(ast, "parse", lambda content: parsed.append(content) or parse(content))
    assert meaning.meanings(files) == expected
    assert parsed == []
    edited = files | {"other": MODULE.replace(b"1.0", b"2.5")}
    assert meaning.meanings(edited)["other"] not in expected.values()
    assert parsed == [edited["other"]]
    for damaged in (b"{", b"[]", b'{"%s": "x"}' % b"0" * 64, b"\xff"):
        file.write_bytes(damaged)
        assert meaning.meanings(files) == expected
    file.unlink()
    file.mkdir()  # it cannot be written
    assert meaning.meanings(files) == expected
    assert list(file.parent.iterdir()) == [file]


def test_other_code_computes_the_meaning_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CLEARANCE_KERNEL_CACHE", str(tmp_path))
    before = meaning.meanings({"one": MODULE})

    def tokens(node: ast.AST, tokens: list[str]) -> None:
        tokens.append(ast.dump(node))

    monkeypatch.setattr(meaning, "_tokens", tokens)
    assert meaning.meanings({"one": MODULE}) != before
    assert len(list((tmp_path / "meanings").iterdir())) == 2


def test_folders_that_are_linked_into_a_package_are_covered(added: Path, tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "model.py").write_bytes(MODULE)
    (added / "linked").symlink_to(tmp_path / "elsewhere")
    (added / "back").symlink_to(added)
    names = sources.note().files.keys()
    assert "added_here.linked.model" in names
    assert not any(name.startswith("added_here.back") for name in names)


def test_ours_and_the_packages_of_entry_points_are_covered(added: Path) -> None:
    noted = sources.note()
    assert noted.files.keys() >= {"added_here", "added_here.post", "added_here.inner.helper"}
    assert noted.files.keys() >= {
        "worker.engine.components.vehicles.unicycle",
        "worker.engine.stages.search",
        "campaigns.stages.plan",
    }
    assert noted.packages["added-here"] == "1.5"
    assert noted.packages["numpy"] == importlib.import_module("numpy").__version__
    before = sources.note().digest
    (added / "inner" / "helper.py").write_bytes(MODULE + b"# a comment\n")
    assert sources.note().digest != before


def test_the_code_of_a_run_is_what_its_campaign_uses() -> None:
    """The engine, the components and methods that it names, and what they import; no word, no verdict, no process."""
    campaign = load_file(library()["unicycle_static"])
    modules = identity.code(campaign).modules
    assert {
        "worker.engine.components.vehicles.unicycle",
        "worker.engine.kernels.maths",
        "worker.engine.kernels.guidance",  # named by generated code only
        "worker.engine.search.methods.direct",
        "worker.engine.stages.validate",
        "campaigns.asked.spec",
        "campaigns.stages.certify",
    } <= modules.keys()
    for name in modules:
        assert name.startswith(("worker.engine.", "campaigns.")), name
        assert not name.startswith("campaigns.claims"), name
    unused = {"worker.engine.components.avoiders.orca", "worker.engine.search.methods.turbo"}
    assert unused <= identity.installation().modules.keys()
    assert not unused & modules.keys()
    assert not any(name.startswith("worker.engine.systems.simulators.") for name in modules)


def test_the_packages_of_a_run_are_those_that_it_imports() -> None:
    used = identity.packages(load_file(library()["unicycle_static"]))
    assert used.keys() >= {"numpy", "numba", "llvmlite", "scipy"}
    assert "cma" not in used
    assert used["numpy"] == importlib.import_module("numpy").__version__


@pytest.mark.parametrize("name", sorted(library()))
def test_every_shipped_campaign_is_identified(name: str) -> None:
    """By the parts that a worker publishes, as the service combines them, and by the modules that it stores."""
    campaign = load_file(library()[name])
    found = identity.code(campaign)
    assert found.digest == code_of(campaign, identity.code_parts())
    assert found.modules.items() <= identity.installation().modules.items()


def test_a_process_is_stale_once_a_file_changed_or_came(added: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sources, "LOADED", sources.note())
    monkeypatch.setattr(sources, "_read", (sources.LOADED.paths, (), ""))
    assert not sources.stale()
    post = added / "post.py"
    os.utime(post)
    assert not sources.stale()
    post.write_bytes(MODULE.replace(b"1.0", b"2.0"))
    assert sources.stale()
    post.write_bytes(MODULE)
    assert not sources.stale()
    (added / "another.py").write_bytes(MODULE)
    assert sources.stale()


@pytest.mark.nightly
def test_an_edit_of_equal_size_in_the_same_second_is_loaded(added: Path) -> None:
    """Bytecode would be taken for current: it is dropped before anything is loaded."""
    post = added / "post.py"
    program = "from worker.running.runs import sources; import added_here.post as post; print(post.X)"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(added.parent), os.getcwd()])}

    for unwanted in ("PYTHONDONTWRITEBYTECODE", "PYTHONPYCACHEPREFIX"):
        environment.pop(unwanted, None)

    def printed() -> str:
        command = [sys.executable, "-c", program]
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.strip()

    at = os.stat(post)
    assert printed() == "1.0"
    post.write_bytes(MODULE.replace(b"1.0", b"2.0"))
    nanoseconds = at.st_mtime_ns // 10**9 * 10**9
    cached = Path(importlib.util.cache_from_source(str(post)))
    os.utime(cached, ns=(nanoseconds, nanoseconds + 1))
    os.utime(post, ns=(nanoseconds, nanoseconds + 2))
    assert printed() == "2.0"


@pytest.mark.nightly
def test_the_live_process_ends_before_it_simulates_with_old_code(added: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(added.parent), os.getcwd()])}
    command = [sys.executable, "-P", "-m", "worker.running.processes.live"]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    asked = json.dumps({"id": 1, "campaign": document(scenario__step=-1.0)}).encode() + b"\n"
    with subprocess.Popen(command, env=environment, **pipes) as live:  # type: ignore[call-overload]
        assert json.loads(live.stdout.readline()) == {"ready": True}
        live.stdin.write(asked)
        live.stdin.flush()
        assert "step" in json.loads(live.stdout.readline())["error"]
        (added / "post.py").write_bytes(MODULE.replace(b"1.0", b"2.0"))
        live.stdin.write(asked)
        live.stdin.flush()
        assert json.loads(live.stdout.readline()) == {"stale": True}
        assert live.wait(10) == 0
