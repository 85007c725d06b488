"""Lines of text to words, expressions and statements, each with its column."""
