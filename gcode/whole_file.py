"""Files that have their name only when they are complete."""

from __future__ import annotations

import contextlib
import uuid
from collections.abc import Iterator
from pathlib import Path


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Path to write to; on success it becomes ``path``, otherwise it is removed.

    Its name is its own, so that two programs that write one file at the same time do not disturb each other: the file
    is that of the one that ends last, and whole.

    Args:
        path: the final name; its suffix is that of the path to write to.

    Raises:
        OSError: it cannot be written.
    """
    partial = path.with_name(f"{path.stem}.{uuid.uuid4().hex[:8]}.partial{path.suffix}")
    try:
        yield partial
        partial.replace(path)
    finally:
        with contextlib.suppress(OSError):
            partial.unlink()
