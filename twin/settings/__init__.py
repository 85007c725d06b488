"""Tables of settings: a record's fields are its TOML keys, its options, its JSON Schema and its page's table."""
