"""What compiled code uses by name: its globals, with the attributes that it reads of them, and what it imports."""

from __future__ import annotations

import dis
from collections.abc import Iterator
from dataclasses import dataclass, field
from types import CodeType

Chain = tuple[str, ...]
"""Attributes read one after the other: `pack.inner.f` is ("inner", "f") of `pack`; () where it is used as it is."""
LOADS = ("LOAD_GLOBAL", "LOAD_NAME", "LOAD_DEREF", "LOAD_FAST")
GLOBAL = ("LOAD_GLOBAL", "LOAD_NAME")
HIDDEN = ("CACHE", "EXTENDED_ARG", "PUSH_NULL", "NOP")


@dataclass(frozen=True)
class Import:
    """An import in the code: dots before the name, the module, and the local name to which the attributes `taken` of
    `base` (dots and all) are bound."""

    level: int
    module: str
    base: str
    taken: Chain
    name: str


@dataclass
class Uses:
    """names: the chains of every name, with the line of their first use; wide: those that are not local only; methods:
    called on objects without a global name, by line; seedless: chains, with their names, that are not called with a
    value; imports: those in the code; unread: whether one of them cannot be read."""

    names: dict[str, dict[Chain, int]] = field(default_factory=dict)
    wide: set[str] = field(default_factory=set)
    methods: dict[str, int] = field(default_factory=dict)
    seedless: set[Chain] = field(default_factory=set)
    imports: list[Import] = field(default_factory=list)
    unread: bool = False

    def chains(self, name: str) -> dict[Chain, int]:
        """The chains of a name, in order."""
        return dict(sorted(self.names.get(name, {}).items()))


def uses(code: CodeType) -> Uses:
    """What code uses, that of functions inside it included."""
    found = Uses()
    _read(code, found)
    return found


def _read(code: CodeType, found: Uses) -> None:
    listed = [i for i in dis.get_instructions(code) if i.opname not in HIDDEN]
    named: set[int] = set()
    for k, instruction in enumerate(listed):
        line = (instruction.positions and instruction.positions.lineno) or 0
        if instruction.opname.startswith(LOADS):
            pair = instruction.argval if isinstance(instruction.argval, tuple) else (instruction.argval,)
            for name in pair[:-1]:
                found.names.setdefault(name, {}).setdefault((), line)
            chain = _chain(listed, k + 1)
            found.names.setdefault(pair[-1], {}).setdefault(chain, line)
            if not _has_value(listed, k + 1 + len(chain)):
                found.seedless.add((pair[-1], *chain))
            if not instruction.opname.startswith("LOAD_FAST"):
                found.wide.update(pair)
            if instruction.opname in GLOBAL:
                named.update(range(k + 1, k + 1 + len(chain)))
        elif k not in named and (instruction.opname == "LOAD_METHOD" or "NULL|self" in instruction.argrepr):
            found.methods.setdefault(str(instruction.argval), line)
        elif instruction.opname == "IMPORT_NAME":
            try:
                found.imports += _imports(listed, k)
            except (ValueError, IndexError):
                found.unread = True
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            _read(constant, found)


def _chain(listed: list[dis.Instruction], k: int) -> Chain:
    names = []
    while k < len(listed) and listed[k].opname in ("LOAD_ATTR", "LOAD_METHOD"):
        names.append(str(listed[k].argval))
        k += 1
    return tuple(names)


def _has_value(listed: list[dis.Instruction], k: int) -> bool:
    """Whether what has just been loaded is called with something other than None."""
    if k >= len(listed):
        return False
    name, value = listed[k].opname, listed[k].argval
    return not name.startswith(("PRECALL", "CALL", "STORE", "RETURN")) and (name, value) != ("LOAD_CONST", None)


def _imports(listed: list[dis.Instruction], k: int) -> Iterator[Import]:
    """What an import binds; raises ValueError for one of another form."""
    level, module = int(listed[k - 2].argval), str(listed[k].argval)
    top, _, inner = module.partition(".")
    if listed[k - 1].argval is None and listed[k + 1].opname != "IMPORT_FROM":  # import a.b binds a
        yield Import(level, module, top, (), _bound(listed[k + 1]))
        return
    if listed[k - 1].argval is None:  # import a.b.c as d
        while not listed[k].opname.startswith("STORE"):
            k += 1
        yield Import(level, module, top, tuple(inner.split(".")), _bound(listed[k]))
        return
    while listed[k + 1].opname == "IMPORT_FROM":  # from a import b, c
        yield Import(level, module, module, (str(listed[k + 1].argval),), _bound(listed[k + 2]))
        k += 2


def _bound(instruction: dis.Instruction) -> str:
    if instruction.opname not in ("STORE_FAST", "STORE_NAME", "STORE_GLOBAL", "STORE_DEREF"):
        raise ValueError(instruction.opname)
    return str(instruction.argval)
