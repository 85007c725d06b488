"""Runs in MCAP files (docs/archive-format.md); the only door to the mcap and protobuf libraries."""

from twin.archive.export import export_forces, read_forces, write_csv
from twin.archive.info import RunInfo, run_info
from twin.archive.reader import read_run

__all__ = ["RunInfo", "export_forces", "read_forces", "read_run", "run_info", "write_csv"]
