"""The formats of tool libraries, one module each: entries of a file to `RawTool`."""
