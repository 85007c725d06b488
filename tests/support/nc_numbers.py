"""Random numbers as NC programs write them."""

from __future__ import annotations

from hypothesis import strategies as st


def digits(most: int, least: int = 1) -> st.SearchStrategy[str]:
    """Digits, also with zeros first and last."""
    return st.builds(lambda n, width: f"{n:0{most}d}"[:width], st.integers(0, 10**most - 1), st.integers(least, most))


def numbers(decimals: int) -> st.SearchStrategy[str]:
    """Numbers of up to nine digits and these decimals: with and without sign, point, and digits on each side of it."""
    sign, whole = st.sampled_from(["", "", "+", "-"]), digits(9)
    after = digits(decimals, 0).map(lambda part: f".{part}")
    size = st.one_of(whole, st.builds(str.__add__, whole, after), digits(decimals).map(lambda part: f".{part}"))
    return st.builds(str.__add__, sign, size)
