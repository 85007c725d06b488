"""Compiling a function, and keeping its compiled code.

Numba itself keeps compiled code next to the source, where it stays behind when the package is removed, does not notice
changes in other files, and numbers its files, so that two processes that compile at the same time may mix them up.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

from twin.jit.sources import source_hash
from twin.jit.store import Store, store
from twin.version import __version__

try:
    from twin.jit.kept_code import CompiledCodeOnly as _CompiledCodeOnly
    from twin.jit.kept_code import KeptCode as _KeptCode
except (ImportError, AttributeError):  # a numba whose internals differ
    _KEPT_CODE: Any = None
else:
    _KEPT_CODE = _KeptCode

_F = TypeVar("_F", bound=Callable[..., Any])
# numba's type hints change from version to version
_NUMBA: Any = numba
#: No function is passed to another one, which is what the wrapper for calls from C is for.
_ALWAYS = {"nogil": True, "no_cfunc_wrapper": True}
_FOR_COMPILED_CODE = {"no_cpython_wrapper": True}


def njit(function: _F) -> _F:
    """Compile a function in nopython mode at its first call, without the GIL; compiled code is kept.

    Under ``NUMBA_DISABLE_JIT=1`` the function stays as it is. A function whose source cannot be read is compiled in
    every process.
    """
    return _compiled(function, {})


def helper(function: _F) -> _F:
    """As `njit`, for a function that only compiled code calls: it compiles faster, and Python cannot call it."""
    return _helper(function, _FOR_COMPILED_CODE)


def inlined(function: _F) -> _F:
    """As `helper`, and the code becomes part of each caller.

    Numba counts references to a function's arrays at each call, unless the function becomes part of its caller or is
    very simple. This is for functions with arrays that are called for every item of an inner loop.
    """
    return _helper(function, {**_FOR_COMPILED_CODE, "forceinline": True})


def folder_name(function: Callable[..., Any]) -> str:
    """The folder for the compiled code of a function's module: version, module, hash of the sources.

    Raises:
        OSError, TypeError: the function has no source that can be read.
    """
    return f"{__version__}/{function.__module__}-{source_hash(Path(inspect.getfile(function)))}"


def _helper(function: _F, options: dict[str, bool]) -> _F:
    if _KEPT_CODE is None:
        return _compiled(function, {})
    compiled: Any = _compiled(function, options)
    if not _NUMBA.config.DISABLE_JIT:
        compiled.__class__ = _CompiledCodeOnly
    return cast(_F, compiled)


def _compiled(function: _F, options: dict[str, bool]) -> _F:
    if _NUMBA.config.DISABLE_JIT:
        return function
    compiled: Any = _NUMBA.njit(**_ALWAYS, **options)(function)
    try:
        folder = folder_name(function)
    except (OSError, TypeError):
        return cast(_F, compiled)
    files = store(_NUMBA.config.CACHE_DIR)
    if _KEPT_CODE is None or not hasattr(compiled, "_cache"):
        return cast(_F, _kept_by_numba(function, files, folder))
    compiled._cache = _KEPT_CODE(function, folder, files)
    return cast(_F, compiled)


def _kept_by_numba(function: Callable[..., Any], files: Store, folder: str) -> Any:
    """Numba's own cache, in the same folder; for versions whose internals are not known."""
    path = files.make(folder)
    if path is None:
        return _NUMBA.njit(**_ALWAYS)(function)
    usual, _NUMBA.config.CACHE_DIR = _NUMBA.config.CACHE_DIR, str(path)
    try:
        return _NUMBA.njit(**_ALWAYS, cache=True)(function)
    finally:
        _NUMBA.config.CACHE_DIR = usual
