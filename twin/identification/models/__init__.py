"""What a test cut's forces are for unit coefficients."""
