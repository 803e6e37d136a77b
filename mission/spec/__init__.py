"""The mission file: frozen values and a strict loader that reports every fault with its line."""
