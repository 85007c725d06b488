"""The one door to numba: compiled functions, kept in the user's cache folder.

`njit` in `twin.jit.compiled`, the hash that compiled code is kept under in `twin.jit.sources`, its files in
`twin.jit.store`.
"""

from twin.jit.compiled import njit

__all__ = ["njit"]
