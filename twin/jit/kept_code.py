"""A function's compiled code in files, instead of numba's own cache, and functions that only compiled code calls.

This is the only module that uses numba's internals; they are the same from 0.60 to 0.68.
"""

from __future__ import annotations

import hashlib
import pickle
import sys
from collections.abc import Callable
from typing import Any

import numba
from numba.core import types
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.registry import CPUDispatcher
from numba.core.serialize import dumps

from twin.jit.notice import compiling
from twin.jit.store import Store

_NUMBA: Any = numba
_RESULT: Any = CompileResult
_DUMPS: Any = dumps
_DISPATCHER: Any = CPUDispatcher
_TYPES: Any = types
# absent in a version of numba that does it in another way
_FROM_PARTS, _TO_PARTS = _RESULT._rebuild, _RESULT._reduce


class CompiledCodeOnly(_DISPATCHER):  # type: ignore[misc]
    """A compiled function without code for calls from Python, which would end the process without a message."""

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """The code that numba calls for arguments of these types: the same for all values of a whole number.

        Numba would compile the function again for each whole number that a caller passes, and for a 0 that a loop
        counts up from, without ever calling the result. For False and True it is compiled twice, which pays.
        """
        named = {name: _without_value(kind) for name, kind in kws.items()}
        return super().get_call_template(tuple(map(_without_value, args)), named)

    def __call__(self, *_: Any, **__: Any) -> Any:
        """Refuse the call.

        Raises:
            TypeError: always.
        """
        raise TypeError(f"{self.__name__} can be called from compiled code only; @njit makes it callable from Python")


def _without_value(kind: Any) -> Any:
    """The type of a whole number whose value numba knows, without the value; other types as they are."""
    return kind.literal_type if isinstance(kind, _TYPES.IntegerLiteral) else kind


class KeptCode(NullCache):
    """The store that numba reads compiled code from before it compiles, and writes it to afterwards.

    Args:
        function: the function in Python.
        folder: name of the folder for its module's code, which changes with the sources.
        files: where the code is kept.
    """

    def __init__(self, function: Callable[..., Any], folder: str, files: Store) -> None:
        self._name = f"{function.__qualname__.replace('<', '').replace('>', '')}-{function.__code__.co_firstlineno}"
        self._folder = folder
        self._files = files

    @property
    def cache_path(self) -> str:
        """The folder, for numba's statistics."""
        return str(self._files.path(self._folder))

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled code for a signature; None when it must be compiled."""
        target_context.refresh()
        contents = self._files.read(self._folder, self._file(sig, target_context.codegen()))
        if contents is None:
            compiling()
            return None
        try:
            kept_sig, parts = pickle.loads(contents)
            return _FROM_PARTS(target_context, *parts) if kept_sig == sig else None
        except Exception:  # pickled by another state of the program: anything may be missing; compile again
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the compiled code for a signature, unless it holds addresses of this process."""
        if any(not part.can_cache for part in data.lifted) or data.library.has_dynamic_globals:
            return
        self._files.write(self._folder, self._file(sig, data.codegen), _DUMPS((sig, _TO_PARTS(data))))

    def _file(self, sig: Any, codegen: Any) -> str:
        """The file's name, from all that code depends on besides the sources: types, versions, processor, options."""
        config = _NUMBA.config
        key = (
            str(sig),
            codegen.magic_tuple(),
            (_NUMBA.__version__, sys.implementation.cache_tag, getattr(sys, "abiflags", "")),
            (config.BOUNDSCHECK, str(config.OPT)),
        )
        return f"{self._name}-{hashlib.sha256(repr(key).encode()).hexdigest()[:16]}.code"
