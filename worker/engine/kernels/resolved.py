"""What numba works out for every call in a kernel, and for every variable that ends, worked out once.

A seventh of the time of a compilation, and the same machine code. Another version of numba compiles as ever.
"""

from __future__ import annotations

from typing import Any
from weakref import WeakKeyDictionary

import numba
from numba.core import types
from numba.core.runtime.context import NRTContext
from numba.core.types.functions import BaseFunction

WRITTEN_FOR = "0.68."
SCALARS = (types.Float, types.Integer, types.Boolean)

_known: WeakKeyDictionary[Any, dict[Any, Any]] = WeakKeyDictionary()
_type_of_call = BaseFunction.get_call_type
_held_in = NRTContext.get_meminfos


def type_of_call(self: Any, context: Any, args: Any, kws: Any) -> Any:
    """`BaseFunction.get_call_type`: for a sum of two floats numba tries the sums of arrays, dates and strings first,
    and formats why each does not apply. For scalars the answer depends on nothing but their types."""
    if kws or not all(isinstance(arg, SCALARS) for arg in args):
        return _type_of_call(self, context, args, kws)
    known = _known.setdefault(self, {})
    if (context, args) not in known:
        signature = _type_of_call(self, context, args, kws)
        known[context, args] = signature, self.get_impl_key(signature)
    signature, self._impl_keys[signature.args] = known[context, args]
    return signature


def held_in(self: Any, builder: Any, ty: Any, val: Any) -> Any:
    """`NRTContext.get_meminfos`: for every variable that ends, numba writes code that takes a tuple of floats apart, to
    find that nothing in it is counted."""
    model = self._context.data_model_manager[ty]
    counted = vars(model).get("_counted")
    if counted is None:
        counted = model._counted = model.contains_nrt_meminfo()
    return _held_in(self, builder, ty, val) if counted else []  # type: ignore[no-untyped-call]


def install() -> None:
    """Have numba use these."""
    if numba.__version__.startswith(WRITTEN_FOR):
        BaseFunction.get_call_type, NRTContext.get_meminfos = type_of_call, held_in  # type: ignore[method-assign]


def uninstall() -> None:
    """Have numba use its own again."""
    BaseFunction.get_call_type, NRTContext.get_meminfos = _type_of_call, _held_in  # type: ignore[method-assign]
