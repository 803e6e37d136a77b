"""T of Eq. 22: the paper's quotient (Fig. 3), and triangles that are never entered."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mission.geometry.regions import label_triangles
from mission.geometry.triangulation import triangulate_nodes
from mission.planning.transition_system import TransitionSystem
from tests.support.curves import paper_labelling, paper_partition
from tests.support.domains import random_nodes
from tests.support.drawn_cases import tried


def test_the_papers_controls_lead_along_the_papers_run() -> None:
    system = TransitionSystem.from_partition(paper_partition(), paper_labelling(), np.zeros(13, dtype=np.bool_))
    states = (0, 8, 11, 12, 4, 5, 7, 3, 1, 5, 4, 12, 10)
    controls = (1, 3, 3, 1, 1, 3, 1, 2, 2, 2, 3, 2, 0)
    assert [int(system.successors[x, u]) for x, u in zip(states, controls, strict=True)] == [*states[1:], 10]
    assert system.size == 13


@tried(40)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(3, 40))
def test_controls_stay_or_cross_the_facet_opposite_their_vertex_into_what_is_open(seed: int, count: int) -> None:
    partition = triangulate_nodes(random_nodes(seed, count))
    rng = np.random.default_rng(seed)
    blocked = rng.random(partition.size) < 0.3
    labelling = label_triangles(partition.size, {"a": rng.random(partition.size) < 0.5})
    system = TransitionSystem.from_partition(partition, labelling, blocked)
    assert (system.successors[:, 0] == np.arange(partition.size)).all()
    assert not system.successors.flags.writeable
    for x in range(partition.size):
        for j in range(3):
            facet = set(np.delete(partition.triangles[x], j).tolist())
            across = [y for y in range(partition.size) if y != x and facet <= set(partition.triangles[y].tolist())]
            expected = across[0] if across and not blocked[across[0]] else -1
            assert system.successors[x, j + 1] == expected
