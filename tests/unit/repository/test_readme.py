"""The examples of README and guides work: the campaign runs, the component simulates, commands and links exist."""

from __future__ import annotations

import json
import re
import shlex
import sys
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer
from typer.core import TyperGroup

from campaigns import check
from campaigns.asked.load import load_text
from clearance.cli import build
from clearance.testing.problems import Problem
from worker.engine.kernels.component import Obstacle, declared
from worker.engine.kernels.layout import Parts
from worker.engine.systems.closed_loop.assemble import Loop
from worker.running.catalogue.installed import catalogue, components, methods

REPOSITORY = Path(__file__).parents[3]
PAGES = [REPOSITORY / "README.md", *sorted((REPOSITORY / "docs").glob("*.md"))]
TEXTS = {page.name: page.read_text(encoding="utf-8") for page in PAGES}


def blocks(language: str, page: str | None = None) -> list[str]:
    """The fenced blocks in that language of README and guides, or of one of them."""
    pattern = re.compile(rf"^```{language}\n(.*?)^```$", re.MULTILINE | re.DOTALL)
    texts = TEXTS.values() if page is None else [TEXTS[page]]
    return [str(found) for text in texts for found in pattern.findall(text)]


def block(language: str, page: str | None = None) -> str:
    """The one fenced block in that language, of all pages or of one."""
    found = blocks(language, page)
    assert len(found) == 1
    return found[0]


def lines() -> list[str]:
    """The command lines in README and guides, with continuation lines joined."""
    return [line for text in blocks("sh") for line in text.replace("\\\n", " ").splitlines()]


def commands() -> list[list[str]]:
    """The arguments of every `clearance` command shown, in blocks and in the text."""
    shown = [*lines(), *(code for text in TEXTS.values() for code in re.findall(r"`(clearance [^`]*)`", text))]
    called = [re.search(r"(?:^|/|\()clearance ([^#)]*)", line) for line in shown]
    return [shlex.split(match[1]) for match in called if match]


def test_the_picture_states_the_stored_verdict_and_size_of_its_campaign() -> None:
    """The independent sample is drawn at every launch, so that the number of evaluations varies by a few."""
    found = re.search(r'library/(\w+)\.yaml`\*: verdict "(\w+)", about ([\d ]+) evaluations', TEXTS["README.md"])
    assert found
    campaign, verdict, evaluations = found.groups()
    known = json.loads((REPOSITORY / "tests/golden/library_verdicts.json").read_text(encoding="utf-8"))[campaign]
    assert verdict == known["verdict"]
    assert int(evaluations.replace(" ", "")) == pytest.approx(sum(known["evaluations"].values()), rel=0.01)


@pytest.mark.parametrize("horizon", [5.0, pytest.param(15.0, marks=pytest.mark.nightly)])
def test_the_campaign_can_be_run(horizon: float) -> None:
    """By day until the obstacle is passed, with longer steps."""
    campaign = load_text(block("yaml", "first-campaign.md"), "first-campaign.md")
    assert check(campaign, catalogue()) == []
    scenario = campaign.given_scenario.model_copy(
        update={"horizon": horizon, "step": 0.02 if horizon < 15.0 else 0.005}
    )
    problem = Problem(campaign.model_copy(update={"scenario": scenario}), compiled=False)
    corners = np.zeros(problem.dimension), np.ones(problem.dimension)
    batch, reasons = problem.evaluate(np.array([problem.nominal_point, *corners]))
    assert reasons == {}
    assert (batch.costs[:, 0] > 0.5).all()
    assert batch.costs.shape == (3, 3)


def test_the_component_can_be_simulated(monkeypatch: pytest.MonkeyPatch) -> None:
    module = types.ModuleType("post")
    monkeypatch.setitem(sys.modules, "post", module)
    exec(compile(block("python", "your-own-component.md"), "post.py", "exec", dont_inherit=True), module.__dict__)
    post: Obstacle = module.component
    assert [p.name for p in declared(post.parameters)] == ["x", "y"]
    known = components()
    parts = Parts(
        known["vehicle", "unicycle"],  # type: ignore[arg-type]
        known["controller", "pid_speed"],  # type: ignore[arg-type]
        known["avoider", "potential_field"],  # type: ignore[arg-type]
        (post,),
        known["criterion", "separation"],  # type: ignore[arg-type]
    )
    loop = Loop(parts, lanes=1, compiled=False)
    given = {"goal.x": 6.0, "goal.y": 7.0, "criterion.threshold": 0.5, "obstacles.0.x": 4.0, "obstacles.0.y": 4.0}
    vector = np.array(
        [given.get(f"{s.prefix}.{p.name}", p.default) for s in loop.sections for p in s.parameters], dtype=np.float64
    )
    flown = loop.simulate(vector[None], 0.005, 1000)
    assert flown.status[0] == 0.0
    assert 0.3 < flown.costs[0, 0] < 1.5


def test_the_python_of_the_guide_runs(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    space: dict[str, Any] = {"__name__": "guide"}
    for text in blocks("python", "python.md"):
        exec(compile(text, "guide.py", "exec", dont_inherit=True), space)
    assert "Cleared" in capsys.readouterr().out
    report = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Python function fly" in report
    assert "Cleared" in report
    assert (tmp_path / "out" / "evidence.json").is_file()
    assert space["result"].worst.parameters == pytest.approx({"mass": 2.3, "drag": 0.2})
    assert space["drop_in_python"](mass=4.0, wind=1.0) == pytest.approx(40 - 100 / 5.2)


def test_the_readme_is_short_and_begins_with_what_it_is() -> None:
    assert len(TEXTS["README.md"].split()) <= 900
    title, sentence, picture, *_ = TEXTS["README.md"].split("\n\n")
    assert title == "# Clearance"
    assert re.fullmatch(r"[^.]+\.", sentence)
    assert picture.startswith("![")
    assert [line.split("#")[0].strip() for line in lines()[:2]] == ["make run", "make test"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_relative_link_leads_somewhere(page: Path) -> None:
    targets = re.findall(r"\]\(([^)\s]+)\)", TEXTS[page.name])
    for target in targets:
        if re.match(r"[a-z]+:", target):
            continue
        path, _, heading = target.partition("#")
        file = page.parent / path if path else page
        assert file.is_file(), target
        names = [
            re.sub(r"[^\w -]", "", line.lstrip("# ")).lower().replace(" ", "-")
            for line in file.read_text(encoding="utf-8").splitlines()
            if heading and line.startswith("#")
        ]
        assert not heading or heading in names, target


def test_every_guide_is_in_the_index_and_in_the_readme() -> None:
    guides = {page.name for page in PAGES[1:]} - {"index.md"}
    assert set(re.findall(r"\]\(([\w-]+\.md)\)", TEXTS["index.md"])) == guides
    assert set(re.findall(r"\]\(docs/([\w-]+\.md)", TEXTS["README.md"])) == guides


def test_every_command_shown_exists() -> None:
    root = typer.main.get_command(build())
    assert isinstance(root, TyperGroup)
    shown = commands()
    assert {words[0] for words in shown} >= {
        "run",
        "audit",
        "trail",
        "submit",
        "follow",
        "reproduce",
        "purge",
        "token",
        "worker",
    }
    for words in shown:
        command = root.commands[words[0]]
        usual = getattr(command, "usual", None)
        if usual and not set("".join(words[1:2]).split("|")) & set(command.commands):
            command = command.commands[usual]  # `clearance audit out/`
        alone = (
            isinstance(command, TyperGroup) and command.invoke_without_command
        )  # `clearance worker`, also with options
        if isinstance(command, TyperGroup) and not (alone and not set(words[1:2]) & set(command.commands)):
            assert set(words[1].split("|")) <= set(command.commands), words
            continue
        known = {name for parameter in command.params for name in parameter.opts}
        assert {word for word in words if word.startswith("--")} <= known, words
        for word in words[1:]:
            assert not word.startswith("campaigns/") or (REPOSITORY / word).is_file(), word


def test_no_help_has_what_rich_takes_for_markup_and_leaves_out() -> None:
    """As `[s]`, which struck out all that follows."""
    waiting, texts = [typer.main.get_command(build())], []
    while waiting:
        command = waiting.pop()
        waiting += list(getattr(command, "commands", {}).values())
        texts += [command.help or "", *(getattr(parameter, "help", None) or "" for parameter in command.params)]
    assert len(texts) > 100
    assert [text for text in texts if re.search(r"(?<!\\)\[[a-z#/@]", text)] == []


def test_every_make_target_shown_exists() -> None:
    makefile = (REPOSITORY / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z-]+):", makefile, re.MULTILINE))
    shown = [line.split("#")[0].split()[1:] for line in lines() if line.startswith("make ")]
    quoted = [code.split() for text in TEXTS.values() for code in re.findall(r"`make ([^`]*)`", text)]
    assert {"run", "test", "nightly", "lint", "types"} <= {name for names in shown for name in names} <= targets
    assert {name for names in quoted for name in names} <= targets


def test_every_folder_and_file_named_exists() -> None:
    pattern = re.compile(r"`((?:campaigns|worker|backend|frontend|tests|tools)/[\w./-]*)`")
    named = {path for text in TEXTS.values() for path in pattern.findall(text)}
    assert len(named) > 20
    assert {path for path in named if not (REPOSITORY / path).exists()} == set()


def test_the_guide_lists_every_method() -> None:
    listed = re.findall(r"^\| ([^|`]+) \| `(\w+)` \|", TEXTS["methods.md"], re.MULTILINE)
    assert sorted(listed) == sorted((method.title, method.name) for method in methods().values())
    fixed = re.search(r"can be extended, except (.*)", TEXTS["methods.md"])
    assert fixed is not None
    assert re.findall(r"`(\w+)`", fixed[1]) == sorted(m.name for m in methods().values() if m.extend is None)


def test_every_test_that_holds_a_decision_exists() -> None:
    decisions = (REPOSITORY / "DECISIONS.md").read_text(encoding="utf-8")
    held = re.findall(r"\*Held\s+by\*\s+(.*?)\.\n(?=- |\n|\Z)", decisions, re.DOTALL)
    assert len(held) > 50
    for entry in held:
        file = ""
        for name in re.findall(r"`([^`]+)`", entry):
            if "/" in name:
                file = (REPOSITORY / name).read_text(encoding="utf-8")
            else:
                assert re.search(rf"def {name}\b", file), name
