"""What is said about a program: statistics, JSON, plots, places with a caret."""
