"""The one door to numba: compiled functions, kept in the user's cache folder.

`njit`, and `helper` and `inlined` for functions that only compiled code calls, in `twin.jit.compiled`; the hash that
compiled code is kept under in `twin.jit.sources`, its files in `twin.jit.store`.
"""

from twin.jit.compiled import helper, inlined, njit

__all__ = ["helper", "inlined", "njit"]
