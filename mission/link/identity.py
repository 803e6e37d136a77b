"""Who we are on the link, and how patient.

We are a ground station (MAV_TYPE_GCS) with system id 255: ArduPilot's ground-station failsafe counts no other id, and
PX4's counts the type, so a vehicle that is set to return when its ground station is lost does so when this program
dies. The component id differs from those of QGroundControl and MAVProxy, which share 255, so that answers to one of
us are not taken for answers to the other.
"""

from dataclasses import dataclass

from mission.link.signing import Signatures


@dataclass(frozen=True)
class LinkOptions:
    """Who we are on the link and how patient.

    Attributes:
        system_id: Our MAVLink system id.
        component_id: Our component id.
        connect_s: How long to wait for a vehicle, on the clock here.
        lost_s: After this long without a message from the vehicle, on the clock here, the link is lost; in flight
            also after so long without its position.
        ready_s: How long to wait for position and health, on the clock here.
        setpoint_s: Vehicle time between two setpoints.
        vehicle_id: System id of the vehicle to fly, where several share the link; 0 takes the first one heard.
        signatures: Signs what is sent, and lets only what is signed be heard; None does neither.
    """

    system_id: int = 255
    component_id: int = 191
    connect_s: float = 30.0
    lost_s: float = 5.0
    ready_s: float = 180.0
    setpoint_s: float = 1.0 / 50.0
    vehicle_id: int = 0
    signatures: Signatures | None = None
