"""The hash of everything that a module's compiled code is made from."""

from __future__ import annotations

import hashlib
import re
from functools import cache
from pathlib import Path

_PACKAGE = Path(__file__).parents[1]
#: ``from twin.a import b, c`` or ``import twin.a``; names in parentheses may be on several lines.
_IMPORT = re.compile(r"^[ \t]*(?:from (twin[\w.]*) import (\([^)]*\)|[^\n]*)|import (twin[\w.]*))", re.M)


@cache
def source_hash(file: Path) -> str:
    """Hash of a module's source and of the sources of all modules of `twin` that it imports, directly or not.

    Compiled code holds a copy of every function and number that it uses, so each of them must be in its key.

    Args:
        file: the module's source.

    Returns:
        16 hexadecimal digits.

    Raises:
        OSError: the source cannot be read.
    """
    sources = {file.name: _read(file)}
    waiting = list(sources[file.name][1])
    while waiting:
        name = waiting.pop()
        path = _file_of(name)
        if path is not None and name not in sources:
            sources[name] = _read(path)
            waiting.extend(sources[name][1])
    digest = hashlib.sha256()
    for name in sorted(sources):
        digest.update(f"{name} {sources[name][0]}\n".encode())
    return digest.hexdigest()[:16]


def _file_of(module: str) -> Path | None:
    """The source of a module of `twin`; None for a name that is not a module."""
    path = _PACKAGE.joinpath(*module.split(".")[1:])
    return next((p for p in (path.with_suffix(".py"), path / "__init__.py") if p.is_file()), None)


@cache
def _read(path: Path) -> tuple[str, frozenset[str]]:
    """Hash of a source, and the names of the modules that it may import."""
    source = path.read_bytes()
    return hashlib.sha256(source).hexdigest(), frozenset(imported_names(source.decode()))


def imported_names(source: str) -> set[str]:
    """The modules of `twin` that a source imports, and the names taken from them, which may be modules too.

    >>> sorted(imported_names("from twin.tools import shape, meridian_kernels as k"))
    ['twin.tools', 'twin.tools.meridian_kernels', 'twin.tools.shape']
    """
    found = set()
    for package, names, module in _IMPORT.findall(source):
        found.add(package or module)
        listed = re.sub(r"#[^\n]*|[()]", "", names)
        found.update(f"{package}.{name.split()[0]}" for name in listed.split(",") if name.strip())
    return found
