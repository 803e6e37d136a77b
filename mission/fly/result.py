"""What a flight came to, and how far it is while it lasts."""

from dataclasses import dataclass

from mission.link.ending import Ending
from mission.monitor.cadence import NONE_SENT, Cadence
from mission.monitor.coverage import Covered, covered_values
from mission.monitor.gaps import Gap
from mission.monitor.monitor import Violation
from mission.monitor.stage import Stage
from mission.monitor.time_bounds import BoundNow
from mission.monitor.verdict import Verdict
from mission.plan import FlightPlan
from mission.spec.model import Point


@dataclass(frozen=True)
class Progress:
    """One moment of a flight, for whoever watches.

    Attributes:
        stage: Where the flight is.
        waiting_for: What the vehicle is waited for, in plain words; empty where nothing is.
        t_s: Vehicle time; None before the vehicle has told it.
        trajectory_s: Time on the trajectory; 0 before it, its duration after it.
        duration_s: Duration of the trajectory; infinite while laps are flown until somebody says that it is enough.
        leg: Which triangle of the path is flown, from 0; counted anew in each lap.
        legs: How many there are.
        done: Letters that brought the automaton nearer to where it accepts for ever.
        total: How many of them the whole way takes at least.
        awaited: Region names that would bring it nearer.
        laps: How often the loop of a recurrent run has been flown.
        laps_asked: How often it is to be flown; None while nobody has said.
        returning: Whether no further lap will be begun.
        verdict: What is known of the word flown so far.
        behind_s: How far this computer is behind what the vehicle says, by its time; 0 while it keeps up.
        told: What has come up so far that the stages do not tell, in plain words: pilots, other plans.
        altitude_m: How high the vehicle is by its last report, up from where the mission's zero lies; None before one.
        speed_m_s: How fast it is over the ground; None before one.
        error_m: How far it is from the trajectory on the axis where that is more; None where it flies none.
        battery_percent: What is left of its charge; None where it does not tell.
        nearest: The restricted region that is nearest, as it is drawn, and how far, m; None where there is none.
        held: Whether the vehicle waits because it was asked to.
        plan: What is flown; None before anything is watched.
        place_m: Where the vehicle is by its last report, ENU in the domain; None before one.
        heading_rad: Where its nose points, clockwise from north; None where it does not tell.
        word: The letters that were spelled by the plan that is flown.
        bounds: What is known of what is asked for in seconds.
        since_s: Since the trajectory began, by the vehicle's clock; 0 before it.
    """

    stage: Stage
    waiting_for: str
    t_s: float | None
    trajectory_s: float
    duration_s: float
    leg: int
    legs: int
    done: int
    total: int
    awaited: tuple[str, ...]
    laps: int
    laps_asked: int | None
    returning: bool
    verdict: Verdict
    behind_s: float = 0.0
    told: tuple[str, ...] = ()
    altitude_m: float | None = None
    speed_m_s: float | None = None
    error_m: float | None = None
    battery_percent: float | None = None
    nearest: tuple[str, float] | None = None
    held: bool = False
    plan: FlightPlan | None = None
    place_m: Point | None = None
    heading_rad: float | None = None
    word: tuple[frozenset[str], ...] = ()
    bounds: tuple[BoundNow, ...] = ()
    since_s: float = 0.0

    @property
    def left_s(self) -> float:
        """What is left of the trajectory."""
        return self.duration_s - self.trajectory_s


@dataclass(frozen=True, eq=False)
class FlightResult:
    """A flight that came to its end.

    Attributes:
        plan: What was to be flown last, planned anew where the mission has a place.
        achieved: Whether the word that the vehicle reported satisfies the specification, without a violation.
        reason: Why, in plain words.
        ending: How it ended.
        interrupted: Whether the user ended it.
        vehicle: Which autopilot flew it.
        began_s: Vehicle time at which the trajectory began; None where it never did.
        ended_s: Vehicle time at the end.
        largest_error_m: Largest distance on an axis from the trajectory; the certificate's tube is about this.
        largest_distance_m: Largest horizontal distance from the trajectory.
        largest_velocity_error_m_s: Largest difference of the velocity, on an axis, from the trajectory's.
        beyond_tube_s: Longest time without a break that the error was beyond the tube.
        word: The letters that were flown.
        laps: How often the loop of a recurrent run was flown.
        gaps: Where nothing was known of the position, or the trajectory paused; the reason names them.
        covered: What was covered of the regions that were to be, visit by visit.
        pictures: The numbers of the pictures that the vehicle told of, in the order in which it did.
        violations: Departures from the domain and entries into restricted regions.
        behind_s: How far this computer was behind what the vehicle said, at most, by its time; 0 where it kept up.
        planned_pictures: How many pictures there were to be.
        plans: What was flown, one plan after the other; the last is ``plan``.
        cadence: How regularly setpoints were sent.
        link_delay_s: How long the link took both ways together, at most, by the vehicle's time.
    """

    plan: FlightPlan
    achieved: bool
    reason: str
    ending: Ending
    interrupted: bool
    vehicle: str
    began_s: float | None
    ended_s: float | None
    largest_error_m: float
    largest_distance_m: float
    beyond_tube_s: float
    word: tuple[frozenset[str], ...]
    laps: int
    gaps: tuple[Gap, ...]
    violations: tuple[Violation, ...]
    behind_s: float = 0.0
    largest_velocity_error_m_s: float = 0.0
    covered: tuple[Covered, ...] = ()
    pictures: tuple[int, ...] = ()
    planned_pictures: int = 0
    plans: tuple[FlightPlan, ...] = ()
    cadence: Cadence = NONE_SENT
    link_delay_s: float = 0.0

    def values(self) -> dict[str, object]:
        """The verdict as values for a record."""
        return {
            "achieved": self.achieved,
            "reason": self.reason,
            "ending": self.ending.name.lower(),
            "interrupted": self.interrupted,
            "largest_error_m": self.largest_error_m,
            "largest_distance_m": self.largest_distance_m,
            "largest_velocity_error_m_s": self.largest_velocity_error_m_s,
            "beyond_tube_s": self.beyond_tube_s,
            "behind_s": self.behind_s,
            **self.cadence.values(),
            "link_delay_s": round(self.link_delay_s, 3),
            "covered": [covered_values(visit) for visit in self.covered],
            "pictures": len(self.pictures),
            "pictures_planned": self.planned_pictures,
            "word": [sorted(letter) for letter in self.word],
            "laps": self.laps,
        }

    @property
    def exit_code(self) -> int:
        """What a program that flies ends with: 0 achieved, 1 flown but not achieved."""
        return 0 if self.achieved else 1
