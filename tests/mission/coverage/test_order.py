"""The order of cells: the best of all by brute force, and near to it where they are too many for that."""

from itertools import permutations, product

import numpy as np
import pytest

from mission.coverage.order import TOURS, Moves, Tours, _best_tours, _improved, best_order, settled, shaken
from mission.geometry.arrays import FloatArray, IntArray


def strewn(seed: int, count: int, *, leave: bool = True) -> Tours:
    """Cells with corners at random in a square: a tour leads from one corner to another."""
    chance = np.random.default_rng(seed)
    ends = chance.uniform(0.0, 10.0, (count, 2, 2, 2))
    begins = np.stack((ends, ends[:, :, ::-1]), axis=2).reshape(count, TOURS, 2, 2)
    first, last = begins[:, :, 0], begins[:, :, 1]
    inner = chance.uniform(5.0, 8.0, (count, 2)).repeat(2, axis=1)
    return Tours(
        inner,
        np.linalg.norm(first, axis=2),
        np.linalg.norm(first - last[:, :, None, None], axis=4),
        np.linalg.norm(last - 10.0, axis=2) if leave else np.zeros((count, TOURS)),
    )


def cost(tours: Tours, order: IntArray, tour: IntArray) -> float:
    total = tours.start[order[0], tour[0]] + tours.end[order[-1], tour[-1]] + tours.inner[order, tour].sum()
    return float(total + tours.between[order[:-1], tour[:-1], order[1:], tour[1:]].sum())


@pytest.mark.parametrize("seed", range(6))
def test_few_cells_are_flown_in_the_best_of_all_orders(seed: int) -> None:
    tours = strewn(seed, 4, leave=seed % 2 == 0)
    order, tour, exact = best_order(tours)
    assert exact
    assert sorted(order) == [0, 1, 2, 3]
    least = min(
        cost(tours, np.array(cells), np.array(ways))
        for cells in permutations(range(4))
        for ways in product(range(TOURS), repeat=4)
    )
    assert cost(tours, order, tour) == pytest.approx(least)


def test_one_cell_is_begun_at_the_corner_at_hand() -> None:
    tours = Tours(np.full((1, 4), 7.0), np.array([[3.0, 1.0, 2.0, 4.0]]), np.zeros((1, 4, 1, 4)), np.zeros((1, 4)))
    order, tour, exact = best_order(tours)
    assert (order.tolist(), tour.tolist(), exact) == ([0], [1], True)


def test_many_cells_are_flown_in_a_good_order_that_is_not_called_the_best() -> None:
    order, _, exact = best_order(strewn(3, 30))
    assert not exact
    assert sorted(order) == list(range(30))
    shares = []
    for seed in range(8):
        tours = strewn(seed, 9)
        best = cost(tours, *best_order(tours)[:2])
        found = _improved(tours.links())
        shares.append(cost(tours, found // TOURS, found % TOURS) / best)
    assert min(shares) >= 1.0 - 1e-9
    assert np.mean(shares) < 1.02
    assert max(shares) < 1.05


def test_the_tours_of_cells_in_an_order_are_the_best() -> None:
    tours = strewn(11, 4)
    chain, least = _best_tours(tours.links(), np.arange(4))
    every = [cost(tours, np.arange(4), np.array(ways)) for ways in product(range(TOURS), repeat=4)]
    assert least == pytest.approx(min(every))
    assert cost(tours, chain // TOURS, chain % TOURS) == pytest.approx(least)


def test_links_are_the_same_both_ways() -> None:
    links: FloatArray = strewn(2, 3).links()[:-2, :-2]
    back = np.arange(len(links)) ^ 1
    np.testing.assert_allclose(links, links[np.ix_(back, back)].T)


def test_a_move_gains_what_it_says_and_there_is_none_left_in_the_best_order() -> None:
    tours = strewn(5, 5)
    order, tour, _ = best_order(tours)
    chain = order * TOURS + tour
    assert Moves(tours.links()).best(chain) is chain
    worse = np.concatenate((chain[3:], chain[:3]))
    moved = Moves(tours.links()).best(worse)
    assert sorted(moved // TOURS) == sorted(worse // TOURS)
    assert cost(tours, moved // TOURS, moved % TOURS) < cost(tours, worse // TOURS, worse % TOURS)


def every_move(chain: IntArray) -> list[IntArray]:
    """All turns of a stretch, and all places to which up to three go, either way round."""
    moved = []
    for begin in range(len(chain)):
        for end in range(begin + 1, len(chain) + 1):
            part, rest = chain[begin:end], np.concatenate((chain[:begin], chain[end:]))
            moved.append(np.concatenate((chain[:begin], part[::-1] ^ 1, chain[end:])))
            if end - begin <= 3:
                for place in range(len(rest) + 1):
                    moved += [np.concatenate((rest[:place], each, rest[place:])) for each in (part, part[::-1] ^ 1)]
    return moved


@pytest.mark.parametrize("seed", range(4))
def test_where_moves_end_hardly_any_move_of_all_is_left_that_gains(seed: int) -> None:
    tours = strewn(seed, 12, leave=seed % 2 == 0)
    links = tours.links()
    begun = np.random.default_rng(seed).permutation(12) * TOURS
    chain = settled(links, begun)
    assert sorted(chain // TOURS) == list(range(12))
    reached = cost(tours, chain // TOURS, chain % TOURS)
    assert reached < cost(tours, begun // TOURS, begun % TOURS)
    found = shaken(links, begun)
    assert sorted(found // TOURS) == list(range(12))
    assert cost(tours, found // TOURS, found % TOURS) <= reached
    best = min(cost(tours, moved // TOURS, moved % TOURS) for moved in every_move(chain))
    assert best > 0.99 * reached
