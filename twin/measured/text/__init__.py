"""Readers of logs that are text: delimited columns, DynoWare exports, LabVIEW measurement files."""
