"""A lock on an open file that ends with the process, however that ends."""

from __future__ import annotations

import errno

try:
    import fcntl
except ImportError:  # Windows: an open file cannot be replaced there anyway
    fcntl = None  # type: ignore[assignment]

_BUSY = (errno.EWOULDBLOCK, errno.EACCES)


def lock(file: int) -> bool:
    """Lock a file for this process.

    Args:
        file: number of the open file; the lock ends when it is closed.

    Returns:
        False if another open file has the lock; True as well on file systems without locks.
    """
    if fcntl is None:
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno not in _BUSY
    return True
