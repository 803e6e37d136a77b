"""Writes what a person reads after a plan or a flight: pictures, a page, and the numbers for machines."""

import json
from pathlib import Path
from typing import Any

from mission.plan import FlightPlan
from mission.report.figures import save_all
from mission.report.inlined import address_of
from mission.report.page import page
from mission.report.pictures import write_pictures
from mission.report.provenance import provenance_rows
from mission.report.reading import Record
from mission.report.record import json_line
from mission.report.summary import summary
from mission.whole_file import write_whole

PAGE_FILE = "report.html"
SUMMARY_FILE = "summary.json"


def figures_of(plan: FlightPlan, record: Record | None) -> str:
    """The map and the histories of a plan and its flight, as markup with what it runs."""
    # Loaded here, for it takes as long as much of the rest.
    from mission.report.interactive.embedding import figures, scripts  # noqa: PLC0415
    from mission.report.interactive.of_flight import flown_of, scene_of  # noqa: PLC0415

    return scripts() + figures(scene_of(plan, record), None if record is None else flown_of(plan, record))


def write_report(
    plan: FlightPlan,
    record: Record | None,
    folder: Path,
    *,
    pictures: bool = True,
    form: str = "png",
    mission_text: str = "",
) -> dict[str, Any]:
    """Write ``report.html``, ``summary.json``, the pictures, and of photographs their places; return the summary.

    Args:
        plan: The plan.
        record: The record of its flight, or None for a plan that was not flown.
        folder: Made if it is not there. Files of an earlier report are replaced, each as a whole.
        pictures: Whether to draw the pictures; the page shows only those.
        form: ``svg`` or ``pdf`` to draw each picture in that format, too.
        mission_text: The mission file as the user wrote it, shown on the page.

    Raises:
        OSError: The folder cannot be written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    numbers = summary(plan, record)
    if record is not None:
        write_pictures(record.pictures, folder)
    # The numbers first: they are there even if the drawing is interrupted.
    write_whole(folder / SUMMARY_FILE, json.dumps(json.loads(json_line(numbers)), indent=2) + "\n")
    drawn = save_all(plan, record, folder, tuple(dict.fromkeys(("png", form)))) if pictures else ()
    shown = [(picture, address_of(folder / picture.file)) for picture in drawn]
    html = page(
        plan,
        record,
        numbers,
        shown,
        figures=figures_of(plan, record),
        made=provenance_rows(folder),
        mission_text=mission_text,
    )
    # A vehicle may send half of a surrogate pair, which no page can hold.
    write_whole(folder / PAGE_FILE, html.encode(errors="replace"))
    return numbers
