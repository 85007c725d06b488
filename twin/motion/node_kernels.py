"""Nodes of the strips that sections are made of; compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.jit import helper

#: Intervals of a section at first, how often each may be halved, and numbers of a node on a stack.
START_INTERVALS, MAX_DEPTH, NODE_FIELDS = 8, 7, 5
#: Sections that differ by less than this part of the tool's radius are the same but for rounding; so is their size.
SAME_SECTION, NO_SECTION = 1e-12, 1e-9
#: Nodes keep this part of half a section's width from its middle, for rounding.
INSET = 1.0 - 1e-12


class Node(NamedTuple):
    """A node of a strip: ``phi`` is the angle whose cosine places u in the section, from 0 to pi."""

    phi: float
    u: float
    lo: float
    hi: float
    fresh: bool


@helper
def repeat_nodes(nodes: FloatArray, fresh: NDArray[np.bool_], first: int, end: int) -> int:
    """Append the last plane's nodes, [first, end), again; returns the number then, or -1 when they do not fit."""
    after = end + (end - first)
    if after > len(nodes):
        return -1
    for n in range(first, end):
        m = n + (end - first)
        nodes[m, 0], nodes[m, 1], nodes[m, 2] = nodes[n, 0], nodes[n, 1], nodes[n, 2]
        fresh[m] = fresh[n]
    return after


@helper
def append_node(node: Node, nodes: FloatArray, fresh: NDArray[np.bool_], written: int) -> int:
    """Append a node unless its section is empty; returns the number of nodes then, or -1 when they do not fit."""
    if written < 0 or not node.lo <= node.hi:
        return written
    if written >= len(nodes):
        return -1
    nodes[written, 0], nodes[written, 1], nodes[written, 2] = node.u, node.lo, node.hi
    fresh[written] = node.fresh
    return written + 1


@helper
def push_node(stack: FloatArray, depth: int, node: Node) -> None:
    """Write a node to a row of a stack."""
    stack[depth, 0], stack[depth, 1], stack[depth, 2], stack[depth, 3] = node.phi, node.u, node.lo, node.hi
    stack[depth, 4] = 1.0 if node.fresh else 0.0


@helper
def node_of(stack: FloatArray, depth: int) -> Node:
    """The node in a row of a stack."""
    return Node(stack[depth, 0], stack[depth, 1], stack[depth, 2], stack[depth, 3], stack[depth, 4] > 0.0)


@helper
def off_chord(u: float, v: float, ua: float, va: float, ub: float, vb: float) -> float:
    """Distance of a point from the chord between two others."""
    du = ub - ua
    dv = vb - va
    length = math.hypot(du, dv)
    if length == 0.0:
        return math.hypot(u - ua, v - va)
    return abs((u - ua) * dv - (v - va) * du) / length
