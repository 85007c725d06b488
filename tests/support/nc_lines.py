"""Random numbers, words and lines as NC programs write them."""

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


COORDINATE = numbers(6)
NUMBERS = {
    "G": st.sampled_from(["0", "1", "00", "01", "2", "03"]),
    "F": st.builds(str.__add__, digits(4), st.sampled_from(["", "."])),
    "S": st.builds(str.__add__, digits(4), st.sampled_from(["", ".", ".5"])),
    "M": st.sampled_from(["3", "4", "05", "7", "08", "9"]),
}
COMMENTS = st.sampled_from(["", "", "", "(c1)", " (X1 G2; )", "(\t%N1)", "( msg, A)", "()"])


@st.composite
def plain_lines(draw: st.DrawFn) -> str:
    """Words in any order, mostly each letter once, with blanks, small letters and both line ends."""
    letters = draw(st.lists(st.sampled_from("XYZXYZGFSM"), max_size=6, unique=draw(st.integers(0, 20)) > 0))
    blank = st.sampled_from(["", "", "", " ", "\t "])
    words = []
    for letter in letters:
        number = draw(NUMBERS.get(letter, COORDINATE))
        words.append(f"{letter}{draw(blank)}{number}{draw(blank)}")
    line = draw(COMMENTS).join(words) + draw(COMMENTS)
    line = draw(st.sampled_from(["", "", "N1 ", f"N{draw(st.integers(0, 999999))}"])) + line
    return (line.lower() if draw(st.integers(0, 9)) == 0 else line) + draw(st.sampled_from(["\n", "\n", "\r\n"]))


#: Ends and centres of arcs from wherever the tool is: small whole numbers, so that many of them fit.
ARC_WORDS = st.sampled_from(
    """G91G2X2I1 | G91G3X-2I-1Z1 | I1J1 | G3I-1 | G2Y3R2 | G3X1Y1R1.0 | X2R-1.5 | G02X.5R0.25 | G2X1Z1I.5
    | X-4Y0Z-1I-2J0 | Y.5J.25S9 | G18G2X2I1 | G19G3Z2K1 | X2K1I0 | G2X1.0000001I.5 | X0.0000001I1 | X1I.50001 | G2X1I.47
    | G3Z1J1 | G2X1I9 | G2X0I0 | G1X1I1 | G2X3R1.5M8 | G3X1Y1R.7 (c) | G90 | G2X5Y5R9 | X1Y1I4J4 | G90.1 | X5I2.5J0
    | G91.1 | G2 | G3X1R-0 | G20 | G21 | G17 | G91 | R3Y1 | I3 | G1X1 | G0Z1M5
    """.replace("\n", "").split("|")
).map(lambda line: line.strip() + "\n")
