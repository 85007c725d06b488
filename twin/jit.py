"""The one door to numba: compiled functions, kept in the user's cache folder.

Numba keeps compiled code beside the source, where uninstalling leaves it behind, and does not see changes in other
files. Here it lies in a folder of the user's cache that carries the module's name and a hash of its source and of
all modules of `twin` that it imports. ``NUMBA_CACHE_DIR`` names another place.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import platformdirs
from numba.core import caching, dispatcher

_F = TypeVar("_F", bound=Callable[..., Any])
# what numba tells of its types changes from version to version
_NUMBA: Any = numba
_CACHING: Any = caching
_DISPATCHER: Any = dispatcher
_ROOT = Path(__file__).parent
_IMPORT = re.compile(r"^from (twin[\w.]*) import \(?([\w, \n]+)", re.M)


def njit(function: _F) -> _F:
    """Compile a function in nopython mode at its first call, without the GIL; compiled code is kept.

    Under ``NUMBA_DISABLE_JIT=1`` the function stays as it is.
    """
    compiled: Any = _NUMBA.njit(nogil=True)(function)
    if isinstance(compiled, _DISPATCHER.Dispatcher):
        compiled._cache = _Cache(function)
    return cast(_F, compiled)


def cache_folder() -> Path:
    """Where compiled kernels are kept."""
    own = _NUMBA.config.CACHE_DIR
    return Path(own) / "twin" if own else Path(platformdirs.user_cache_dir("machining-twin")) / "kernels"


@cache
def source_hash(module: str) -> str:
    """Hash of a module's source and of the sources of all modules of `twin` that it imports, directly or not."""
    sources = _sources(module, {})
    digest = hashlib.sha256()
    for name in sorted(sources):
        digest.update(f"{name}\n{sources[name]}\n".encode())
    return digest.hexdigest()[:16]


def _sources(module: str, found: dict[str, str]) -> dict[str, str]:
    path = _ROOT.joinpath(*module.split(".")[1:])
    path = path.with_suffix(".py") if path.with_suffix(".py").is_file() else path / "__init__.py"
    if module in found or not path.is_file():
        return found
    found[module] = path.read_text("utf-8")
    for package, names in _IMPORT.findall(found[module]):
        _sources(package, found)
        for name in names.replace("\n", " ").split(","):
            _sources(f"{package}.{name.split(' as ')[0].strip()}", found)
    return found


class _Locator:
    """Tells numba where a function's compiled code lies; its duck type since numba 0.60."""

    def __init__(self, function: Callable[..., Any]) -> None:
        module = function.__module__
        self._hash = source_hash(module)
        self._line = function.__code__.co_firstlineno
        self._folder = cache_folder() / f"{module}-{self._hash}"

    @classmethod
    def from_function(cls, function: Callable[..., Any], _file: str) -> _Locator:
        return cls(function)

    def get_cache_path(self) -> str:
        return str(self._folder)

    def ensure_cache_path(self) -> None:
        self._folder.mkdir(parents=True, exist_ok=True)

    def get_source_stamp(self) -> str:
        return self._hash

    def get_disambiguator(self) -> str:
        return str(self._line)


class _CacheImpl(_CACHING.CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = [_Locator]  # noqa: RUF012


class _Cache(_CACHING.FunctionCache):  # type: ignore[misc]
    _impl_class = _CacheImpl
