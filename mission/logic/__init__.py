"""Linear temporal logic: formulas, their meaning on words, and their automata."""
