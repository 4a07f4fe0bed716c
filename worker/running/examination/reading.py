"""Reads the text of a component's file: its syntax, names that do not exist, and what a kernel cannot contain.

Nothing is executed.
"""

from __future__ import annotations

import ast
import builtins
import io
import symtable
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from worker.running.examination.mistake import Mistake, listed, meant

LARGEST = 1_000_000
"""The largest file that is read [bytes]."""

DEEPEST = 400
"""The deepest nesting of its syntax tree: a sum of 300 terms is fine."""

KINDS = ("Vehicle", "Controller", "Avoider", "Obstacle", "Environment", "Fault", "Criterion")

Function = ast.FunctionDef
Scope = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda | ast.ClassDef

_FORBIDDEN: dict[type[ast.AST], str] = {
    ast.Raise: "`raise`, and a kernel cannot raise: return NaN where it has no result, or let the vehicle's `outside` "
    "end the simulation",
    ast.Assert: "`assert`, and a kernel cannot raise: give the parameter limits, or remove it",
    ast.Try: "`try`, and a kernel cannot catch exceptions: compute both cases and select with `a if condition else b`",
    ast.With: "`with`, which kernels cannot contain: they compute with floats and tuples only",
    ast.Yield: "`yield`, and a kernel is not a generator: return a tuple",
    ast.YieldFrom: "`yield from`, and a kernel is not a generator: return a tuple",
    ast.Await: "`await`, which kernels cannot contain",
    ast.Global: "`global`, and a kernel cannot change anything outside: keep the value in a state or in the memory",
    ast.Nonlocal: "`nonlocal`, and a kernel cannot change anything outside: keep the value in a state or in the memory",
    ast.Import: "an import inside a kernel: move it to the top of the file",
    ast.ImportFrom: "an import inside a kernel: move it to the top of the file",
    ast.FunctionDef: "a function inside a kernel: move it to the top of the file and decorate it with @kernel",
    ast.ClassDef: "a class inside a kernel: move it to the top of the file",
    ast.Lambda: "`lambda`, which kernels cannot contain: write a function at the top of the file with @kernel",
    ast.List: "a list, and kernels compute with floats and tuples: write (a, b) in place of [a, b]",
    ast.ListComp: "a list comprehension, and kernels compute with floats and tuples: write the elements out",
    ast.Dict: "a dict, and kernels compute with floats and tuples: use a tuple",
    ast.DictComp: "a dict comprehension, and kernels compute with floats and tuples: use a tuple",
    ast.Set: "a set, and kernels compute with floats and tuples: use a tuple",
    ast.SetComp: "a set comprehension, and kernels compute with floats and tuples: use a tuple",
    ast.GeneratorExp: "a generator, and kernels compute with floats and tuples: write the elements out",
    ast.JoinedStr: "a text, and kernels compute with floats and tuples only: remove it",
}


@dataclass(frozen=True)
class Source:
    """A file, its text, its syntax tree, and where it binds its names."""

    file: Path
    text: str
    tree: ast.Module
    table: symtable.SymbolTable

    @cached_property
    def functions(self) -> dict[str, Function]:
        """The functions at the top of the file, by name; of two with the same name the last one."""
        return {node.name: node for node in self.tree.body if isinstance(node, ast.FunctionDef)}

    @cached_property
    def classes(self) -> dict[str, ast.ClassDef]:
        """The classes at the top of the file, by name."""
        return {node.name: node for node in self.tree.body if isinstance(node, ast.ClassDef)}

    @cached_property
    def kernels(self) -> list[Function]:
        """The functions that are decorated with `kernel`."""
        return [f for f in self.functions.values() if any(_last_name(d) == "kernel" for d in f.decorator_list)]

    @cached_property
    def names(self) -> set[str]:
        """Names that the file itself has."""
        bound = {s.get_name() for s in self.table.get_symbols() if s.is_assigned() or s.is_imported()}
        return bound | {name for node in ast.walk(self.tree) if isinstance(node, ast.Global) for name in node.names}

    def scope(self, function: Function | ast.AsyncFunctionDef) -> symtable.SymbolTable:
        """The names of a function."""
        known = (function.name, function.lineno)
        return next(s for s in _within(self.table) if (s.get_name(), s.get_lineno()) == known)

    @cached_property
    def declaration(self) -> ast.expr | None:
        """The value of `component = ...`, the last one."""
        found = None
        for node in self.tree.body:
            targets = node.targets if isinstance(node, ast.Assign) else []
            targets = [node.target] if isinstance(node, ast.AnnAssign) else targets
            if isinstance(node, ast.Assign | ast.AnnAssign) and any(_last_name(t) == "component" for t in targets):
                found = node.value
        return found

    def argument(self, field: str) -> ast.expr | None:
        """The value given for a field of the declaration, if it is written as a keyword."""
        call = self.declaration
        keywords = call.keywords if isinstance(call, ast.Call) else []
        return next((keyword.value for keyword in keywords if keyword.arg == field), None)

    def line_of(self, field: str = "") -> int:
        """The line of a field of the declaration, or else of the declaration."""
        node = (self.argument(field) if field else None) or self.declaration
        return node.lineno if node is not None else 0

    def line_of_parameter(self, owner: str, field: str) -> int:
        """The line of a field of a class, or else of the class."""
        node = self.classes.get(owner)
        for inner in node.body if node is not None else []:
            if isinstance(inner, ast.AnnAssign) and _last_name(inner.target) == field:
                return inner.lineno
        return node.lineno if node is not None else self.line_of("parameters")


def read(file: Path) -> Source:
    """The file's text and tree; raises `Mistake`."""
    try:
        content = file.read_bytes()
    except OSError as error:
        raise Mistake(f"the file cannot be read: {error.strerror}") from None
    if len(content) > LARGEST:
        raise Mistake(f"the file has {len(content):,} bytes, and a component has at most {LARGEST:,}")
    try:
        encoding, _ = tokenize.detect_encoding(io.BytesIO(content).readline)
        text = content.decode(encoding)
        tree = ast.parse(content, str(file))
        if _depth(tree) > DEEPEST:
            raise RecursionError
        return Source(file, text, tree, symtable.symtable(text, str(file), "exec"))
    except SyntaxError as error:
        text = str(error.msg).rstrip(".")
        raise Mistake(f"this is not Python: {text}; correct the line", error.lineno) from None
    except (UnicodeDecodeError, LookupError, ValueError):
        raise Mistake("the file is not text in UTF-8: save it as UTF-8", 1) from None
    except (RecursionError, MemoryError):
        raise Mistake("an expression is nested too deeply to be read: divide it", 1) from None


def _depth(tree: ast.AST) -> int:
    """How deep a tree is nested, found without recursion."""
    deepest, waiting = 0, [(tree, 1)]
    while waiting:
        node, depth = waiting.pop()
        deepest = max(deepest, depth)
        waiting += [(inner, depth + 1) for inner in ast.iter_child_nodes(node)]
    return deepest


def check(source: Source) -> None:
    """Raises `Mistake` for the first one in the text."""
    for cls in source.classes.values():
        _check_fields(cls)
    for kernel in source.kernels:
        _check_kernel(kernel, source)
    if source.declaration is None and "component" not in source.names:
        for node in source.tree.body:
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
                kind, name = _last_name(node.value.func), _last_name(node.targets[0])
                if kind in KINDS:
                    raise Mistake(
                        f"the {kind} is called {name}, expected component: write component = ...", node.lineno
                    )
        raise Mistake(
            "there is no `component = ...` in the file: declare at its end what it is, "
            "such as component = Vehicle(name=...)",
            len(source.text.splitlines()),
        )


def _check_fields(cls: ast.ClassDef) -> None:
    """Fields of a NamedTuple without an annotation, which Python takes for something else."""
    if not any(_last_name(base) == "NamedTuple" for base in cls.bases):
        return
    for node in cls.body:
        if isinstance(node, ast.Assign):
            name = _last_name(node.targets[0]) or "the field"
            raise Mistake(
                f"{cls.name}.{name} has no annotation, so it is not a parameter: "
                f'write {name}: Annotated[float, Parameter("unit", "Text", low, high)] = ...',
                node.lineno,
            )


def check_names(source: Source) -> None:
    """Raises `Mistake` for a name in a function that exists nowhere; the import finds those at the top."""
    if any(isinstance(n, ast.ImportFrom) and any(a.name == "*" for a in n.names) for n in ast.walk(source.tree)):
        return
    known = source.names | set(dir(builtins)) | {"__name__", "__file__", "__doc__"}
    for function in ast.walk(source.tree):
        if not isinstance(function, Function | ast.AsyncFunctionDef):
            continue
        scope = source.scope(function)
        unknown = globals_of(scope) - known
        for node in loads(function):
            if node.id in unknown:
                known_names = sorted((source.names | set(scope.get_identifiers())) - unknown)
                advice = meant(node.id, known_names, "define or import it")
                raise Mistake(f"{node.id} in {function.name} is not defined: {advice}", node.lineno)


def _within(scope: symtable.SymbolTable) -> Iterator[symtable.SymbolTable]:
    for inner in scope.get_children():
        yield inner
        yield from _within(inner)


def globals_of(scope: symtable.SymbolTable) -> set[str]:
    """The names that a function, or one in it, reads and that are bound in neither."""
    read = [s for each in (scope, *_within(scope)) for s in each.get_symbols() if s.is_referenced()]
    return {s.get_name() for s in read if s.is_global()}


def _outside_functions(node: ast.AST) -> Iterator[ast.AST]:
    for inner in ast.iter_child_nodes(node):
        yield inner
        if not isinstance(inner, Scope):
            yield from _outside_functions(inner)


def loads(node: ast.AST) -> Iterator[ast.Name]:
    """The names that the body of a function reads, without annotations, which are not executed."""
    for field, value in ast.iter_fields(node):
        if field in ("annotation", "returns", "decorator_list") or (field == "args" and isinstance(node, Scope)):
            continue
        for inner in value if isinstance(value, list) else [value]:
            if isinstance(inner, ast.Name) and isinstance(inner.ctx, ast.Load):
                yield inner
            elif isinstance(inner, ast.AST):
                yield from loads(inner)


def _check_kernel(kernel: Function, source: Source) -> None:
    for statement in kernel.body:
        for node in ast.walk(statement):
            if type(node) in _FORBIDDEN:
                raise Mistake(f"{kernel.name} contains {_FORBIDDEN[type(node)]}", getattr(node, "lineno", 0))
    for loop in (node for node in ast.walk(kernel) if isinstance(node, ast.While)):
        if not _bounded(loop):
            raise Mistake(
                f"{kernel.name} contains `while` without a bound, and a simulation that does not end cannot be "
                "stopped: write for _ in range(50), or count the turns: while n < 50 and ..., with n += 1",
                loop.lineno,
            )
    if kernel.args.vararg or kernel.args.kwarg or kernel.args.kwonlyargs:
        raise Mistake(f"{kernel.name} takes * arguments, and a kernel is called by position: name each", kernel.lineno)
    for default in kernel.args.defaults:
        if what := _mutable(default):
            raise Mistake(
                f"{kernel.name} has {what} as a default value, which keeps what a call writes for the next: remove it",
                default.lineno,
            )
    if not _returns(kernel.body):
        raise Mistake(
            f"{kernel.name} can end without `return`, and a kernel returns a value in every branch: add it",
            kernel.lineno,
        )
    _check_lengths(kernel)
    _check_globals(kernel, source)


def _bounded(loop: ast.While) -> bool:
    """Whether its condition compares a counter with what the loop does not change, and every turn counts."""
    if any(isinstance(node, ast.Continue) for node in ast.walk(loop)):
        return False
    stored = {n.id for n in ast.walk(loop) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    counts = {
        (node.target.id, type(node.op))
        for node in loop.body
        if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name)
        if isinstance(node.value, ast.Constant) and isinstance(node.value.value, int) and node.value.value > 0
    }
    both = isinstance(loop.test, ast.BoolOp) and isinstance(loop.test.op, ast.And)
    for test in loop.test.values if both else [loop.test]:  # type: ignore[attr-defined]
        if isinstance(test, ast.Compare) and len(test.ops) == 1 and isinstance(test.left, ast.Name):
            ends = ast.Add if isinstance(test.ops[0], ast.Lt | ast.LtE) else ast.Sub
            fixed = not stored & {n.id for n in ast.walk(test.comparators[0]) if isinstance(n, ast.Name)}
            ordered = isinstance(test.ops[0], ast.Lt | ast.LtE | ast.Gt | ast.GtE)
            if ordered and fixed and (test.left.id, ends) in counts:
                return True
    return False


def _returns(body: list[ast.stmt]) -> bool:
    """Whether every path through these statements ends with `return`."""
    for statement in body:
        if isinstance(statement, ast.Return):
            return statement.value is not None
        if isinstance(statement, ast.If) and _returns(statement.body) and _returns(statement.orelse):
            return True
        if isinstance(statement, ast.While) and isinstance(statement.test, ast.Constant) and statement.test.value:
            return True
        if isinstance(statement, ast.Match) and all(_returns(case.body) for case in statement.cases):
            return True
    return False


def _check_lengths(kernel: Function) -> None:
    """Branches that return tuples of different lengths, or a number in one and a tuple in another."""
    first: tuple[int, int] | None = None
    returns = [node for node in ast.walk(kernel) if isinstance(node, ast.Return)]
    for node in sorted(returns, key=lambda node: node.lineno):
        for value in _arms(node.value):
            length = _length(value)
            if length is None:
                continue
            if first is not None and length != first[0]:
                raise Mistake(
                    f"{kernel.name} returns {_counted(length)} here and {_counted(first[0])} at line {first[1]}: "
                    "return as many in every branch",
                    value.lineno,
                )
            first = first or (length, value.lineno)


def _arms(value: ast.expr | None) -> list[ast.expr]:
    if isinstance(value, ast.IfExp):
        return [*_arms(value.body), *_arms(value.orelse)]
    return [] if value is None else [value]


def _length(value: ast.expr) -> int | None:
    """The number of values that an expression plainly has; None if that is not plain, 0 for a number alone."""
    if isinstance(value, ast.Tuple):
        return None if any(isinstance(e, ast.Starred) for e in value.elts) else len(value.elts)
    if isinstance(value, ast.Constant):
        return 0 if isinstance(value.value, int | float) else None
    if isinstance(value, ast.UnaryOp):
        return _length(value.operand)
    return None


def _counted(length: int) -> str:
    return "a number" if length == 0 else f"a tuple of {length}"


def _check_globals(kernel: Function, source: Source) -> None:
    """Kernels read constants only: the compiled form keeps the value that a name had."""
    read = globals_of(source.scope(kernel)) & source.names
    for node in loads(kernel):
        if node.id not in read:
            continue
        bound = [n for n in _outside_functions(source.tree) if _binds(n, node.id)]
        shared = [n for n in ast.walk(source.tree) if isinstance(n, ast.Global) and node.id in n.names]
        lines = sorted({n.lineno for n in [*bound, *shared]})  # type: ignore[attr-defined]
        if len(lines) > 1:
            raise Mistake(
                f"{kernel.name} reads {node.id}, which is assigned more than once (lines {listed(map(str, lines))}), "
                "and the compiled form keeps one value: use a constant, a parameter or a state",
                node.lineno,
            )
        what = next((_mutable(n.value) for n in bound if isinstance(n, ast.Assign | ast.AnnAssign) and n.value), "")
        if what:
            raise Mistake(
                f"{kernel.name} reads {node.id}, {what} (line {lines[0]}), and kernels read constants only: "
                "make it a tuple of numbers",
                node.lineno,
            )


def _binds(node: ast.AST, name: str) -> bool:
    if isinstance(node, ast.Assign):
        return any(isinstance(n, ast.Name) and n.id == name for t in node.targets for n in ast.walk(t))
    return isinstance(node, ast.AnnAssign | ast.AugAssign) and _last_name(node.target) == name


def _mutable(value: ast.expr) -> str:
    kinds = {ast.List: "a list", ast.ListComp: "a list", ast.Dict: "a dict", ast.DictComp: "a dict", ast.Set: "a set"}
    if isinstance(value, ast.Call) and _last_name(value.func) in ("list", "dict", "set", "bytearray", "defaultdict"):
        return f"a {_last_name(value.func)}"
    return kinds.get(type(value), "")


def _last_name(node: ast.AST) -> str:
    """`kernel` of `kernel`, `maths.kernel` and `maths.kernel(...)`."""
    if isinstance(node, ast.Call):
        return _last_name(node.func)
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""
