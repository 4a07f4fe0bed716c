"""`pytest --processes N`: collects once, then runs groups of tests in N forks of the process that has collected.

pytest-xdist collects in every process, which took a twentieth of the suite's processor time. The hook `pytest_group_of`
tells which tests stay together, `pytest_waits` which of them mostly wait for other processes: half of the forks run
these first, the others begin with what computes, so that both are under way all the time. A fork that dies is reported
and replaced.
"""

from __future__ import annotations

import atexit
import contextlib
import gc
import os
import sys
import traceback
import warnings
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, Pipe, wait
from types import SimpleNamespace
from typing import Any

import pytest

SHOWING = ("terminalreporter", "terminalprogress", "junitxml", "lfplugin", "nfplugin", "stepwiseplugin")
"""Plugins that show or store reports. They stay with the process that all reports come to."""


class Hooks:
    """What this plugin asks."""

    @pytest.hookspec(firstresult=True)
    def pytest_group_of(self, item: pytest.Item) -> str:
        """The name of a group whose tests run in one process, one after another; by default the item's file."""
        raise NotImplementedError

    @pytest.hookspec(firstresult=True)
    def pytest_waits(self, item: pytest.Item) -> bool:
        """Whether the item's group waits for other processes more than it computes; by default it does not."""
        raise NotImplementedError


def pytest_addoption(parser: pytest.Parser, pluginmanager: pytest.PytestPluginManager) -> None:
    parser.addoption("--processes", type=int, default=0, metavar="N", help="run groups of tests in N processes")
    pluginmanager.add_hookspecs(Hooks)


@pytest.hookimpl(trylast=True)
def pytest_group_of(item: pytest.Item) -> str:
    """The group of a test by default."""
    return item.nodeid.partition("::")[0]


def pytest_runtestloop(session: pytest.Session) -> bool | None:
    """All groups, in their order; as pytest would by itself where no processes are asked for."""
    count = session.config.getoption("processes")
    if count < 1 or session.config.option.collectonly or session.testsfailed:
        return None
    session.config.pluginmanager.get_plugin("terminalreporter").showfspath = False
    session.config._tmp_path_factory.getbasetemp()  # type: ignore[attr-defined]  # made once, for all
    with Parent(session) as parent:
        parent.run(count)
    if session.shouldfail:
        raise session.Failed(session.shouldfail)
    if session.shouldstop:
        raise session.Interrupted(session.shouldstop)
    return True


def groups(session: pytest.Session) -> list[Group]:
    """All groups in the order of their first test."""
    found: dict[str, Group] = {}
    hook = session.config.hook
    for place, item in enumerate(session.items):
        name = hook.pytest_group_of(item=item)
        if name not in found:
            found[name] = Group(waits=bool(hook.pytest_waits(item=item)))
        found[name].places.append(place)
    return list(found.values())


@dataclass
class Group:
    """Places of tests that one process runs, one after another."""

    waits: bool
    """Whether they wait more than they compute."""
    places: list[int] = field(default_factory=list)


@dataclass
class Fork:
    """A process that runs tests, as its parent sees it."""

    number: int
    pid: int
    connection: Connection
    left: list[int] = field(default_factory=list)
    """Tests that it was given and has not ended, the running one first."""


@dataclass
class Parent:
    """Hands out groups and passes on what is reported. No fork outlives its `with`."""

    session: pytest.Session
    forks: dict[Connection, Fork] = field(default_factory=dict)
    waiting: list[Group] = field(default_factory=list)

    def __enter__(self) -> Parent:
        self.waiting = groups(self.session)
        return self

    def __exit__(self, *_: object) -> None:
        for fork in self.forks.values():
            fork.connection.close()  # it ends where it asks next, or by the Ctrl-C that all have got
            os.waitpid(fork.pid, 0)

    def run(self, count: int) -> None:
        for number in range(min(count, len(self.waiting))):
            self.fork(number)
        while self.forks:
            for connection in wait(list(self.forks)):
                assert isinstance(connection, Connection)
                self.receive(self.forks[connection])

    def fork(self, number: int) -> None:
        ours, theirs = Pipe()
        sys.stdout.flush()
        sys.stderr.flush()
        pid = os.fork()
        if pid:
            theirs.close()
            self.forks[ours] = Fork(number, pid, ours)
            return
        for connection in (ours, *self.forks):
            connection.close()
        _run_as_fork(self.session, theirs)

    def receive(self, fork: Fork) -> None:
        hook = self.session.config.hook
        statement, content = _received(fork.connection)
        if statement == "ended":
            self.lost(fork)
        elif statement == "ready":
            self.hand_out(fork)
        elif statement == "warned":
            hook.pytest_warning_recorded.call_historic(kwargs=content)
        else:
            fork.left.pop(0)
            self.log(_named(fork), *content)

    def log(self, node: SimpleNamespace, reports: list[dict[str, Any]], test: dict[str, Any]) -> None:
        """Pass on what a process reported of a test."""
        hook = self.session.config.hook
        hook.pytest_runtest_logstart(**test)
        for data in reports:
            report = hook.pytest_report_from_serializable(config=self.session.config, data=data)
            report.node = node
            hook.pytest_runtest_logreport(report=report)
            if report.failed:  # at once: a run of an hour may be ended before it prints its failures
                self.session.config.get_terminal_writer().line(f"\nfailed: {report.nodeid}")
        hook.pytest_runtest_logfinish(**test)

    def hand_out(self, fork: Fork) -> None:
        stopped = self.session.shouldfail or self.session.shouldstop
        places = [] if stopped else self.following(waits=fork.number % 2 == 0)
        fork.left += places
        with contextlib.suppress(ConnectionError):  # it died meanwhile, which is received next
            fork.connection.send(places)

    def following(self, waits: bool) -> list[int]:
        """Take the tests of the next group, if possible of one that waits or does not."""
        if not self.waiting:
            return []
        at = next((at for at, group in enumerate(self.waiting) if group.waits == waits), 0)
        return self.waiting.pop(at).places

    def lost(self, fork: Fork) -> None:
        """It has ended. Where tests are left, the one that ran has failed, and another fork runs the others."""
        self.forks.pop(fork.connection).connection.close()
        code = os.waitstatus_to_exitcode(os.waitpid(fork.pid, 0)[1])
        if not fork.left and code == 0:
            return
        ended = f"ended by signal {-code}" if code < 0 else f"ended with code {code}"
        if not fork.left:
            self.session.testsfailed += 1
            self.session.config.get_terminal_writer().line(f"\nprocess {fork.number} {ended} after its tests")
            return
        item = self.session.items[fork.left[0]]
        text = f"process {fork.number} {ended} while it ran {item.nodeid}"
        report = pytest.TestReport(item.nodeid, item.location, {}, "failed", text, "call")
        self.session.config.hook.pytest_runtest_logreport(report=report)
        if len(fork.left) > 1:
            self.waiting.insert(0, Group(waits=fork.number % 2 == 0, places=fork.left[1:]))
        if self.waiting:
            self.fork(fork.number)


def _received(connection: Connection) -> tuple[str, Any]:
    try:
        message: tuple[str, Any] = connection.recv()
    except (EOFError, ConnectionError):
        return "ended", None
    return message


def _named(fork: Fork) -> SimpleNamespace:
    """What pytest's terminal knows of pytest-xdist: by this it shows reports of several processes as they come."""
    name = f"process {fork.number}"
    return SimpleNamespace(gateway=SimpleNamespace(id=name), _workerinfocache=f"[{name}]")


def _run_as_fork(session: pytest.Session, connection: Connection) -> None:
    """Never returns: what follows in the process that collected is not this one's."""
    atexit._clear()
    code = 1
    try:
        _alone(session.config)
        session.config.pluginmanager.register(Child(session.config, connection))
        _run_tests(session, connection)
        code = 0
    except (ConnectionError, KeyboardInterrupt):
        pass  # the parent was interrupted, and says so
    except BaseException:
        traceback.print_exc()
    finally:
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def _alone(config: pytest.Config) -> None:
    """Shows nothing but stacks of what takes too long; what tests print goes to files that no other process has."""
    plugins = config.pluginmanager
    writer = config.get_terminal_writer()
    for name in SHOWING:
        if plugin := plugins.get_plugin(name):
            plugins.unregister(plugin)
    plugins.register(SimpleNamespace(_tw=writer), "terminalreporter")
    if captured := plugins.get_plugin("capturemanager"):
        captured.stop_global_capturing()
        captured.start_global_capturing()
        captured.suspend_global_capture()


def _run_tests(session: pytest.Session, connection: Connection) -> None:
    """Asks for another group before the last test of one: which test is next tells which fixtures end.

    What a group leaves behind is not searched for garbage again.
    """

    def asked() -> list[int]:
        gc.collect()
        gc.freeze()
        connection.send(("ready", None))
        group: list[int] = connection.recv()
        return group

    items, places = session.items, asked()
    try:
        while places and not (session.shouldfail or session.shouldstop):
            item = items[places.pop(0)]
            places = places or asked()
            after = items[places[0]] if places else None
            session.config.hook.pytest_runtest_protocol(item=item, nextitem=after)
    finally:
        session._setupstate.teardown_exact(None)


@dataclass(frozen=True, eq=False)
class Child:
    """Tells the parent what happens, of each test at once: a message costs as much as a short test."""

    config: pytest.Config
    connection: Connection
    reports: list[dict[str, Any]] = field(default_factory=list)
    """Of the test that runs."""

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.reports.append(self.config.hook.pytest_report_to_serializable(config=self.config, report=report))

    def pytest_runtest_logfinish(self, nodeid: str, location: tuple[str, int | None, str]) -> None:
        self.connection.send(("test", (self.reports, {"nodeid": nodeid, "location": location})))
        self.reports.clear()

    def pytest_warning_recorded(
        self, warning_message: warnings.WarningMessage, when: str, nodeid: str, location: tuple[str, int, str] | None
    ) -> None:
        text = f"{warning_message.category.__name__}: {warning_message.message}"
        bare = warnings.WarningMessage(text, Warning, warning_message.filename, warning_message.lineno)  # to be pickled
        content = {"warning_message": bare, "when": when, "nodeid": nodeid, "location": location}
        self.connection.send(("warned", content))
