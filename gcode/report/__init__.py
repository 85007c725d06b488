"""Reports about a program: motions as arrays and JSON, statistics, plots, geometry of paths."""
