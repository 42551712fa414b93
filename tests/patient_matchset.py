"""`matchset` whose serial link waits longer for an answer: for tests on a computer that is busy with other things.

Run as a program with the arguments of `matchset`.
"""

import functools

TIMEOUT = 4.0  # s, in place of `ArduinoParameters.timeout`


def main() -> None:
    from matchset import cli
    from matchset.links.arduino import arduino_link
    from matchset.links.arduino.protocol import ArduinoParameters

    patient = functools.partial(ArduinoParameters, timeout=TIMEOUT, startup_timeout=20.0, arm_timeout=20.0)
    setattr(arduino_link, "ArduinoParameters", patient)  # noqa: B010 - in its place
    cli.main()


if __name__ == "__main__":
    main()
