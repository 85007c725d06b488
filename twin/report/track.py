"""The path of the tool with the force on it, thinned so that memory does not grow with the program."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from twin.arrays import FloatArray
from twin.record import Step

#: Most pieces that are kept; with more, short neighbours are joined.
MOST_PIECES = 16_384


@dataclass(frozen=True, slots=True, kw_only=True)
class Track:
    """Pieces of the path in order.

    Attributes:
        start_mm, end_mm: shape (n, 3), tool tip in the workpiece frame.
        resultant_n: shape (n,), largest resultant on the piece, 0 in air.
        rapid: shape (n,), whether the piece is a rapid motion.
    """

    start_mm: FloatArray
    end_mm: FloatArray
    resultant_n: FloatArray
    rapid: np.ndarray[tuple[int], np.dtype[np.bool_]]


class _Piece(NamedTuple):
    start_mm: tuple[float, float, float]
    end_mm: tuple[float, float, float]
    peak_n: float
    rapid: bool

    def length_mm(self) -> float:
        return sum(abs(b - a) for a, b in zip(self.start_mm, self.end_mm, strict=True))

    def joined(self, following: _Piece) -> _Piece:
        return _Piece(self.start_mm, following.end_mm, max(self.peak_n, following.peak_n), self.rapid)


class TrackKeeper:
    """Takes the steps of a run."""

    def __init__(self) -> None:
        self._pieces: list[_Piece] = []
        self._least_mm = 0.0

    def add(self, step: Step, peak_n: float) -> None:
        """Take one step.

        Args:
            peak_n: largest resultant in it.
        """
        if step.start_mm == step.end_mm:
            return
        self._put(self._pieces, _Piece(step.start_mm, step.end_mm, peak_n, step.rapid))
        while len(self._pieces) > MOST_PIECES:
            self._thin()

    def track(self) -> Track:
        """The pieces so far."""
        ends = np.array([(p.start_mm, p.end_mm) for p in self._pieces], dtype=np.float64).reshape(-1, 2, 3)
        return Track(
            start_mm=ends[:, 0],
            end_mm=ends[:, 1],
            resultant_n=np.array([p.peak_n for p in self._pieces], dtype=np.float64),
            rapid=np.array([p.rapid for p in self._pieces], dtype=bool),
        )

    def _put(self, pieces: list[_Piece], piece: _Piece) -> None:
        """Add a piece, or join it to the last one if that is short and of the same kind."""
        if pieces:
            last = pieces[-1]
            if last.rapid == piece.rapid and last.end_mm == piece.start_mm and last.length_mm() < self._least_mm:
                pieces[-1] = last.joined(piece)
                return
        pieces.append(piece)

    def _thin(self) -> None:
        """Join pieces shorter than most; without any neighbours to join omit rapids, or else every second piece."""
        pieces = self._pieces
        self._least_mm = max(2.0 * self._least_mm, 1.5 * float(np.median([p.length_mm() for p in pieces])))
        kept: list[_Piece] = []
        for piece in pieces:
            self._put(kept, piece)
        if len(kept) == len(pieces):
            kept = [p for p in pieces if not p.rapid] if any(p.rapid for p in pieces) else pieces[::2]
        self._pieces = kept
