"""A run of the product automaton, seen as triangles: a lasso."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Run:
    """A lasso of triangles: ``prefix`` once, then ``suffix`` for ever.

    The suffix begins at an accepting product state; ``prefix + suffix`` lists each state once, so the paper's run is
    ``prefix = (0, 8, ..., 12)``, ``suffix = (10,)``. ``controls[i]`` is the paper's u_j (0 to 3) applied in state
    ``i`` of ``prefix + suffix``; the last one leads back to ``suffix[0]``.

    Attributes:
        prefix: Triangle indices before the loop; empty where the start state is itself the head of the loop.
        suffix: Triangle indices of the loop, at least one.
        controls: One control a state, ``len(prefix) + len(suffix)`` of them.
    """

    prefix: tuple[int, ...]
    suffix: tuple[int, ...]
    controls: tuple[int, ...]

    @property
    def states(self) -> tuple[int, ...]:
        """Every state of the lasso, once."""
        return self.prefix + self.suffix

    @property
    def cost(self) -> int:
        """Number of transitions, the one that closes the loop included."""
        return len(self.prefix) + len(self.suffix)

    @property
    def recurrent(self) -> bool:
        """Whether the loop moves; False where it is a stay in one triangle."""
        return len(set(self.suffix)) > 1
