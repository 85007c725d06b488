"""From passes to a program: links, entries, order, arcs, times, NC text."""
