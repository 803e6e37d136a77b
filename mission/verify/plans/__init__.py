"""Whether what a plan file claims is true, found out anew from the numbers in it.

**Theorem.** A *flight* is within h of r(s) on each axis (the *tube*, h metres) while s runs from 0 to T without going
back. No flight meets what is restricted or leaves the domain, and its word (the label of each triangle that it enters)
satisfies the mission. The certificate cuts the curve r into pieces and names a set of triangles for each. It follows of

1. *domain*: triangles and labels are those that the mission in the file makes (``checker``).
2. *tube*: while s is in a piece, the tube meets only the piece's triangles, none restricted, and leaves the domain
   nowhere. r is a polynomial in Bernstein's form on each of its patches (``patches``), up to a known error, and
   lies in the hull of its control points; that hull, grown by h, is looked up among the triangles (``tube.stray``).
3. *words*: so a flight walks through these sets in order, and changes its triangle within one. All that it can spell,
   with what follows the end (to stay, or the lap again), are the words of a finite graph; in its product with an
   automaton of the negated formula no accepting cycle is reached (``words.spells``).

Who named the triangles, and how, does not matter. The other rows are about what else the mission asks for or the file
tells. Where a bound must hold all along a curve it is one of these; ``bernstein.undecided`` proves each in the same
way, by control points, and cuts pieces in halves where these say too little. Nothing rests on samples.

=========  =====================================================  ==========================  =======================
row        polynomial, and on what                                must be                     where
=========  =====================================================  ==========================  =======================
tube       r(s) with the square of half width h, on a piece       in the named triangles      ``tube.stray``
figures    r(s), on the curve                                     as far off as it is told    ``tube.far_enough``
time law   velocity, acceleration, jerk of r(s(t)), on a step     at most the limits, and     ``motion.excess``
           of the law s(t)                                        those of its regions
heading    w |q|^2 - q x q' and w |q|^2 + q x q', q where the     not negative, w the yaw     ``flight.heading_kept``
           nose looks, on a step of the law                       rate
=========  =====================================================  ==========================  =======================

Where triangles move, the first two are judged in time (``moving``): a part of the curve against the hull of each
triangle while that part is flown, and 0.05 s before and after. The distance may be more than is told.

Without bounds: *mission*, what the file repeats of it; *run*, a walk through the sets that satisfies the mission;
*path* and *curve*, which join, and where fields steer, lead as the paper's equations say and make the series of their
path (``fields``); *stops*, *lanes* and *photographs*, in the places and with the times that they need.

Three things are taken as the file has them: the mission (``mission verify PLAN --mission FILE`` compares it), what an
earlier plan covered, and the velocity of a flight that begins in the air; the figures of the rows tell the latter two.

Nothing is shared with the planner but geometry, automata, and the reader of missions. The files in the order in
which they are best read: ``bernstein``, ``patches``, ``tube``, ``words``, ``proof``; ``written``, ``checker``;
``motion``, ``moving``, ``flight``, ``lanes``, ``fields``.
"""

from mission.verify.plans.checker import JUDGED, Claim, claims

__all__ = ["JUDGED", "Claim", "claims"]
