"""What the text of a Python file reads of the state outside of it, and which data files it declares.

Only the part that a simulator of the file may execute counts: not what is under `if __name__ == "__main__":`, nor
functions that no simulator uses. Start reading at `external`.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field

from worker.engine.systems.simulators.declared.outside import BUILTINS, METHODS, SEEDED, Outside, outside

Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef
DECORATOR, READS = "simulator", "reads"
IMPORTS = ("__import__", "import_module", "importlib.import_module")


@dataclass(frozen=True)
class Use:
    """A name that reads something; package: that it is of, which may turn out to be one's own; empty if none."""

    line: int
    kind: Outside
    name: str
    package: str = ""


@dataclass
class External:
    """uses: in the order of lines; reads: the expressions of the declared data files."""

    uses: list[Use] = field(default_factory=list)
    reads: list[ast.expr] = field(default_factory=list)


def external(tree: ast.Module) -> External:
    """What the text of a file reads from outside, and the data files that it declares."""
    reader = Reader(tree)
    found = [use for node in _executed(tree) for use in reader.of(node)]
    return External(sorted(set(found), key=lambda use: (use.line, use.name)), list(_declared(tree)))


def _declared(tree: ast.Module) -> Iterator[ast.expr]:
    """The elements of `reads` of every simulator, which may name a list of the module."""
    lists = {
        n.targets[0].id: n.value for n in tree.body if isinstance(n, ast.Assign) and isinstance(n.targets[0], ast.Name)
    }
    for call in filter(_decorates, ast.walk(tree)):
        for keyword in call.keywords:  # type: ignore[attr-defined]
            if keyword.arg == READS:
                value = keyword.value
                value = lists.get(value.id, value) if isinstance(value, ast.Name) else value
                yield from value.elts if isinstance(value, ast.List | ast.Tuple | ast.Set) else [value]


def _decorates(node: ast.AST) -> bool:
    if not isinstance(node, ast.Call):
        return False
    name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
    return name == DECORATOR


def _executed(tree: ast.Module) -> list[ast.stmt]:
    """The statements of a module that its simulators may execute; all but the main block if it has no simulator."""
    tops = [node for node in tree.body if not is_main(node)]
    roots = [n for n in tops if not isinstance(n, Definition) or any(map(_decorates, n.decorator_list))]
    if not any(isinstance(node, Definition) for node in roots):
        return tops
    defined = {node.name: node for node in tops if isinstance(node, Definition) and node not in roots}
    found, waiting = [], list(roots)
    while waiting:
        node = waiting.pop()
        found.append(node)
        names = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)} & defined.keys()
        waiting += [defined.pop(name) for name in sorted(names)]
    return found


def is_main(node: ast.stmt) -> bool:
    """Whether it is executed only if the file is the program."""
    return isinstance(node, ast.If) and ast.unparse(node.test) in ("__name__ == '__main__'", "'__main__' == __name__")


class Reader:
    """Names of one file: what they are imported from, and what the file itself binds."""

    def __init__(self, tree: ast.Module) -> None:
        self.imported: dict[str, str] = {}
        self.local: frozenset[str] = frozenset()
        """Names that the function at hand binds."""
        self.modules: set[str] = set()
        """Names of modules."""
        self.stars: list[str] = []
        """Modules of which everything is imported."""
        self.defined = {node.name for node in ast.walk(tree) if isinstance(node, Definition)}
        self.bound = {node.name for node in tree.body if isinstance(node, Definition)}
        for top in (node for node in tree.body if not isinstance(node, Definition)):
            self.bound |= _stored(top)
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                for alias in node.names:
                    whole = alias.name if alias.asname else alias.name.partition(".")[0]
                    self.imported[alias.asname or whole] = whole
                    self.modules.add(alias.asname or whole)
            elif isinstance(node, ast.ImportFrom) and not node.level:
                self.stars += [str(node.module) for alias in node.names if alias.name == "*"]
                self.imported |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
        self.renamed: set[int] = set()
        """Names that only give another name to what is imported, by id."""
        for node in ast.walk(tree):
            if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
                dotted = self._dotted(node.value)
                if dotted is not None and isinstance(node.value, ast.Name | ast.Attribute):
                    self.imported.setdefault(node.targets[0].id, dotted)
                    self.renamed.add(id(node.value))

    def of(self, top: ast.AST) -> Iterator[Use]:
        """What a statement reads."""
        calls = {id(node.func): node for node in ast.walk(top) if isinstance(node, ast.Call)}
        inner = {id(node.value) for node in ast.walk(top) if isinstance(node, ast.Attribute)}
        for node, self.local in _scoped(top, frozenset()):
            if isinstance(node, ast.Attribute | ast.Name) and isinstance(node.ctx, ast.Load):
                if id(node) not in inner:
                    yield from self._of_name(node, calls.get(id(node)))
                elif isinstance(node, ast.Attribute):  # in the middle of a chain: Path(x).open().read()
                    yield from self._of_method(node, calls.get(id(node)))
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "getattr" and len(node.args) > 1:
                yield from self._of_getattr(node)

    def _of_name(self, node: ast.Attribute | ast.Name, call: ast.Call | None) -> Iterator[Use]:
        dotted = self._dotted(node)
        if dotted is None:
            if isinstance(node, ast.Attribute):
                yield from self._of_method(node, call)
            elif node.id in BUILTINS and node.id not in self.bound | self.local and not _writes(call, 1):
                yield Use(node.lineno, BUILTINS[node.id], node.id)
            return
        kind = outside(dotted)
        seeded = dotted in SEEDED and call is not None and _seeded(call)
        if kind is not None and not seeded and not (kind is Outside.FILES and _writes(call, 1)):
            yield Use(node.lineno, kind, ast.unparse(node), dotted.partition(".")[0])
        elif isinstance(node, ast.Name) and node.id in self.modules and id(node) not in self.renamed:
            yield Use(node.lineno, Outside.VALUE, dotted, dotted.partition(".")[0])

    def _of_method(self, node: ast.Attribute, call: ast.Call | None) -> Iterator[Use]:
        """Yield the use of a method that reads state outside, of an object that is not known by its name."""
        kind = METHODS.get(node.attr)
        if kind is None or call is None or node.attr in self.defined or self._dotted(node) is not None:
            return
        if not _writes(call, 0) and not any(k.arg == "random_state" for k in call.keywords):
            yield Use(node.lineno, kind, node.attr)

    def _of_getattr(self, node: ast.Call) -> Iterator[Use]:
        base, attribute = node.args[0], node.args[1]
        dotted = self._dotted(base)
        if dotted is None:
            return
        if not isinstance(attribute, ast.Constant) or not isinstance(attribute.value, str):
            yield Use(node.lineno, Outside.VALUE, dotted, dotted.partition(".")[0])
        elif (kind := outside(f"{dotted}.{attribute.value}")) is not None:
            yield Use(node.lineno, kind, f"{dotted}.{attribute.value}", dotted.partition(".")[0])

    def _dotted(self, node: ast.expr) -> str | None:
        """The full name of what is imported; None for anything else."""
        names: list[str] = []
        while isinstance(node, ast.Attribute):
            names.insert(0, node.attr)
            node = node.value
        if isinstance(node, ast.Call) and ast.unparse(node.func) in IMPORTS and node.args:
            module = node.args[0]
            return ".".join([str(module.value), *names]) if isinstance(module, ast.Constant) else None
        if not isinstance(node, ast.Name) or node.id in self.local:
            return None
        if node.id in self.imported:
            return ".".join([self.imported[node.id], *names])
        every = [".".join([module, node.id, *names]) for module in self.stars if node.id not in self.bound]
        return next((dotted for dotted in every if outside(dotted) is not None), None)


def _scoped(node: ast.AST, local: frozenset[str]) -> Iterator[tuple[ast.AST, frozenset[str]]]:
    """Every node inside with the names that its functions bind to something that is not imported."""
    yield node, local
    for inner in ast.iter_child_nodes(node):
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            yield from _scoped(inner, local)
        elif isinstance(inner, ast.arguments):
            for default in (*inner.defaults, *(d for d in inner.kw_defaults if d is not None)):
                yield from _scoped(default, local)
        else:
            yield from _scoped(inner, local | _bound_in(node))


def _bound_in(function: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) -> frozenset[str]:
    """Names that a function binds; not those that it may bind to what is imported."""
    arguments = function.args
    found = {a.arg for a in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)}
    waiting: list[ast.AST] = list(function.body) if isinstance(function.body, list) else []
    imported = set[str]()
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Name | ast.Attribute):
            imported |= _stored(node)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            imported |= {alias.asname or alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.Global):
            imported |= set(node.names)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
        if not isinstance(node, ast.Lambda | Definition):
            waiting += ast.iter_child_nodes(node)
    return frozenset(found - imported)


def _stored(top: ast.AST) -> set[str]:
    """Names that a statement binds."""
    stored = {n.id for n in ast.walk(top) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    return stored | {n.arg for n in ast.walk(top) if isinstance(n, ast.arg)}


def _seeded(call: ast.Call) -> bool:
    arguments = [*call.args, *(k.value for k in call.keywords)]
    return bool(arguments) and not (isinstance(arguments[0], ast.Constant) and arguments[0].value is None)


def _writes(call: ast.Call | None, position: int) -> bool:
    """Whether a call opens a file only to write it; position: of its mode."""
    if call is None:
        return False
    modes = [*call.args[position : position + 1], *(k.value for k in call.keywords if k.arg == "mode")]
    texts = [str(mode.value) for mode in modes if isinstance(mode, ast.Constant)]
    return any(text[:1] in ("w", "a", "x") and "+" not in text for text in texts)
