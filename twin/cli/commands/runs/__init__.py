"""Commands about runs: making, showing, exporting them."""
