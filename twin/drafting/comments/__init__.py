"""Comments of NC programs that posts write: tools and stock, in words and in the forms of each post."""
