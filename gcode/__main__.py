"""``python -m gcode``."""

from gcode.cli import main

main()
