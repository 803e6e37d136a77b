"""The transition system of a partition, its product with an automaton, and shortest accepting runs."""
