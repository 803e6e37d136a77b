"""Whether what a plan file claims is true, found out anew from the numbers in it.

What is claimed: every flight whose position stays in the *tube*, within h of r(s) on each axis while s runs from 0 to
T without going back, meets nothing restricted, and the word that it spells satisfies the mission. A word is read as a
vehicle reads it: the label of each triangle that it enters.

Why these rows suffice. The certificate cuts the curve into pieces and names a set of triangles for each.

- *domain*: triangles and labels are those that the mission in the file makes. So it does not matter what the file says.
- *tube*: while s is in a piece, the tube meets the piece's triangles only, none of them restricted, and does not leave
  the domain. Each piece of the curve is a polynomial in Bernstein's form, which lies in the hull of its control points;
  that hull, grown by the tube, is looked up among the triangles, and cut in halves where it meets too many.
- *words*: so the flight is a walk through these sets, in order, that changes its triangle within one. All its words,
  with whatever comes after the end (staying there, or the lap again and again), are those of a finite graph, and in
  the product of that with an automaton of the negated formula no accepting cycle can be reached.

Nothing else is needed for the claim: who named the triangles, and how, does not matter. The other rows are about what
else the mission asks for, or the file tells: *run*, that it is a walk through the sets, and satisfies the mission;
*path* and *curve*, that legs join, and that fields lead where the paper's equations say and the curve is the series of
their path; *figures*, the distance from what is restricted; *time law*, *stops*, *lanes*, *photographs* and *heading*,
how the curve is flown. A law s(t) is a polynomial of time between its knots, and so are r(s(t)) and its derivatives:
speed, acceleration, jerk and yaw rate are bounded by control points, too, and nothing rests on samples.

Nothing is shared with the planner but geometry, automata, and the reader of missions. The files in the order in which
they are best read: ``patches``, ``tube``, ``words``, ``proof``; ``written`` and ``checker``; ``motion``, ``flight``,
``lanes``, ``fields``.
"""

from mission.verify.plans.checker import JUDGED, Claim, claims

__all__ = ["JUDGED", "Claim", "claims"]
