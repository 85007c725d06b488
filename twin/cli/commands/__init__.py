"""The commands of `twin`, one module each, in folders by subject."""
