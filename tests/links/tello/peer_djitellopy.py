"""A flight by djitellopy, in an environment of its own: `.ci/setup-tello`.

    peer_djitellopy.py PORT STATES     a Tello whose commands are at UDP port PORT of this computer, states at STATES

It prints what it sees, JSON; its errors are its own.
"""

import json
import sys
import time

from djitellopy import Tello


def main() -> None:
    Tello.STATE_UDP_PORT = int(sys.argv[2])
    Tello.CONTROL_UDP_PORT = 0  # any, for this computer's side
    drone = Tello("127.0.0.1")
    drone.address = "127.0.0.1", int(sys.argv[1])
    drone.connect()
    seen = {"battery": drone.query_battery(), "on the floor": drone.get_height()}
    drone.takeoff()
    seen["in the air"] = drone.get_height()
    until = time.monotonic() + 1.0
    while time.monotonic() < until:
        drone.send_rc_control(0, 40, 30, -20)
        time.sleep(0.05)
    drone.send_rc_control(0, 0, 0, 0)
    time.sleep(0.3)
    seen |= {"higher": drone.get_height(), "turned": drone.get_yaw(), "state battery": drone.get_battery()}
    drone.land()
    seen["landed"] = drone.get_height()
    print(json.dumps(seen))


if __name__ == "__main__":
    main()
