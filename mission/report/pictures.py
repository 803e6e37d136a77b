"""Where each picture of a flight was taken, in the files that photogrammetry programs read.

``images.csv`` has the columns of Pix4D: name, latitude, longitude, height, yaw, pitch, roll, accuracies level and in
height where they are known of all pictures; Agisoft Metashape imports the same with these columns chosen.
``geo.txt`` is OpenDroneMap's: the reference system, then name, longitude, latitude and the same numbers.
Degrees and metres, WGS 84, heights above mean sea level. A camera that looks straight down with the top of its images
ahead has yaw, pitch and roll of the vehicle. MAVLink does not tell how the camera names its files: they are numbered
from 1 in the order in which pictures were taken, those that nothing was heard of included.
"""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from mission.report.reading import Picture
from mission.whole_file import write_whole

IMAGES_FILE: Final = "images.csv"
GEO_FILE: Final = "geo.txt"
_HEAD: Final = "#imagename,latitude,longitude,z,yaw,pitch,roll"
_ACCURACIES: Final = ",accuracy horz,accuracy vert"


def write_pictures(pictures: Sequence[Picture], folder: Path) -> None:
    """Write both files into a folder, each as a whole; none where no place of a picture is known.

    Raises:
        OSError: The folder cannot be written to.
    """
    rows = [(_name(each, pictures), each) for each in pictures if all(map(math.isfinite, each.place))]
    if not rows:
        return
    exact = all(math.isfinite(number) for _, each in rows for number in each.accuracy_m)
    lines = [_HEAD + (_ACCURACIES if exact else "")]
    places = ["EPSG:4326"]
    for name, each in rows:
        latitude, longitude, height = (f"{each.place[0]:.7f}", f"{each.place[1]:.7f}", f"{each.place[2]:.3f}")
        rest = [height, *_angles(each), *([f"{number:.2f}" for number in each.accuracy_m] if exact else [])]
        lines.append(",".join([name, latitude, longitude, *rest]))
        places.append(" ".join([name, longitude, latitude, *rest]))
    write_whole(folder / IMAGES_FILE, "\n".join(lines) + "\n")
    write_whole(folder / GEO_FILE, "\n".join(places) + "\n")


def _name(picture: Picture, pictures: Sequence[Picture]) -> str:
    return f"{picture.number - min(each.number for each in pictures) + 1:04d}.JPG"


def _angles(picture: Picture) -> list[str]:
    """Yaw from 0 to 360, pitch and roll; zeros where the vehicle did not tell them."""
    roll, pitch, yaw = (math.degrees(angle) if math.isfinite(angle) else 0.0 for angle in picture.attitude_rad)
    return [f"{yaw % 360.0:.2f}", f"{pitch:.2f}", f"{roll:.2f}"]
