"""An MCAP file that grows safely: chunks, interrupts, partial files."""
