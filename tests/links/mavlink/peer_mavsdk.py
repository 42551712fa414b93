"""An autopilot by MAVSDK's server plugins, in an environment of its own: `.ci/setup-mavlink`.

    peer_mavsdk.py PORT     speaks to UDP port PORT of this computer

Lines on stdin: ``armable 1`` or ``0``, ``text WORDS`` (a warning), ``disarm``. Lines on stdout, JSON: every message
that it receives, by MAVSDK's own parser, and what it was told to do.
"""

import json
import sys
import threading
import time
from typing import Any

from mavsdk.component_type import ComponentType
from mavsdk.mavsdk import Configuration, Mavsdk
from mavsdk.plugins.action_server.action_server import ActionServer, AllowableFlightModes
from mavsdk.plugins.mavlink_direct.mavlink_direct import MavlinkDirect
from mavsdk.plugins.telemetry_server.telemetry_server import StatusText, StatusTextType, TelemetryServer


def tell(**facts: Any) -> None:
    print(json.dumps(facts), flush=True)


def listen(sdk: Mavsdk, kept: list[Any]) -> None:
    """Wait for the ground station, then pass all its messages on."""
    while not (systems := sdk.get_systems()):
        time.sleep(0.05)
    direct = MavlinkDirect(systems[0])
    direct.subscribe_message("", lambda got, _: tell(name=got.message_name, fields=json.loads(got.fields_json)))
    kept += [systems, direct]
    tell(listening=True)


def main() -> None:
    sdk = Mavsdk(Configuration.create_with_component_type(ComponentType.AUTOPILOT))
    sdk.add_any_connection(f"udpout://127.0.0.1:{sys.argv[1]}")
    server = sdk.server_component()
    action, telemetry = ActionServer(server), TelemetryServer(server)
    action.set_allowable_flight_modes(AllowableFlightModes(can_guided_mode=True, can_stabilize_mode=True))
    action.set_armable(True, True)
    action.set_disarmable(True, True)
    action.subscribe_arm_disarm(lambda _, what, __: tell(arm=what.arm, force=what.force))
    kept: list[Any] = []
    threading.Thread(target=listen, args=(sdk, kept), daemon=True).start()
    for line in sys.stdin:
        word, _, rest = line.strip().partition(" ")
        if word == "armable":
            action.set_armable(rest == "1", rest == "1")
        elif word == "text":
            telemetry.publish_status_text(StatusText(StatusTextType.WARNING, rest))
        elif word == "disarm":
            action.set_armed_state(False)


if __name__ == "__main__":
    main()
