"""Measured force logs: files in, axes mapped, corrections made one by one, each on record (docs/measured-logs.md)."""

from twin.measured.axes import AxisMap
from twin.measured.forces import force_log
from twin.measured.log import Channel, ForceLog, RawLog
from twin.measured.read import read_log

__all__ = ["AxisMap", "Channel", "ForceLog", "RawLog", "force_log", "read_log"]
