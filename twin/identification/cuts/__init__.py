"""The test cuts: their file, their logs, their steady part."""
