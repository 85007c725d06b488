"""The tri-slice workpiece: from stock or mesh, through removal, to a mesh."""
