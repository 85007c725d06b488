"""A job file drafted from an NC program: what the program states, what is assumed, and what contradicts itself.

`twin.drafting.draft.draft_job` is the entry. Comments of posts are read by tables of patterns (`tool_posts`,
`stock_posts`), the program is run once for the extent of its cuts (`cuts`), and every value that the program does not
state is an `Assumption`: a comment in the file and a line on the terminal.
"""
