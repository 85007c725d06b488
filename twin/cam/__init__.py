"""Computer-aided manufacturing: where a tool may go, tool paths from slices, NC programs from them."""
