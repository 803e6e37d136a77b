"""Mission files drafted from what other programs draw."""
