"""Readers of log files, one module a format; `twin.measured.read` recognises a file and calls its reader."""
