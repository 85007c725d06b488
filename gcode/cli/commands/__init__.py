"""The commands of `gcode`, one file each."""
