"""The Hanoi Omega-Automata format: reading and writing automata as text."""
