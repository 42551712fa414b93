"""What is typed for a real flight, and what is missing in it: refused in one line that says what to type."""

from pathlib import Path

import pytest

from blue_ball import Matchset
from matchset.flight.chain.config import default_toml, read_followers
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.linked.opening import check_followers, open_camera, open_link
from matchset.flight.linked.options import LinkedOptions
from matchset.flight.linked.parameters import LinkedFollower, LinkedParameters

LINK = "serial:///dev/ttyUSB0"


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (LINK, f"it needs a camera: matchset fly --camera 0 --link {LINK} --camera-file"),
        ("--arm", "say whom to fly: --camera 0 --link"),
        ("--link serial:///dev/ttyUSB0", "--camera 0 is missing"),
        ("--camera 0", "--link serial:///dev/ttyUSB0 is missing"),
        ("sim://chain --arm", "sim://chain is a simulated chain: the options of a real vehicle"),
        ("--camera 0 --link LINK --arm --dry-run", "give --arm or --dry-run, not both"),
        ("--camera 0 --link LINK --seed 3", "--seed is for a simulated chain"),
        ("--camera 0 --link LINK", "made by 'matchset calibrate 0 --board 9x6"),
        ("--camera 0 --link LINK --fov 60 --camera-file c.toml", "one of the two"),
        ("--camera 0 --link LINK --fov 190", "between 0 and 180, got 190"),
        ("--camera 0 --link LINK --fov 60", "made by 'matchset learn 0 --pick X,Y -o ball.npz'"),
        (
            "--camera 0 --link LINK --fov 60 --color ball.npz",
            "made by 'matchset learn 0 --pick X,Y --marker -o marker.npz'",
        ),
        ("--camera 0 --link LINK --fov 60 --delay-ms nan", "delay_ms must be within 0 ... 1000, got nan"),
        ("--camera 0 --link LINK --fov 60 --turn 45", "turn must be 0, 90, 180 or 270 degrees, clockwise, got 45"),
        ("--turn 180", "say whom to fly: --camera 0 --link"),
        ("--camera 0 --link LINK --fov 60 --timeout 0", "timeout must be positive, got 0"),
        ("--camera 0 --link LINK --fov 60 --reconnect -1", "reconnect must be a time in s, 0 for none, got -1"),
        ("--camera 0 --link LINK --fov 60 --diameter -1", "diameter"),
        ("--camera 0 --link LINK --fov 60 --focal-sigma 2", "focal_sigma is a share of the focal length, from 0 to 1"),
        ("--camera 0 --link LINK --fov 60 --diameter-sigma 0.3", "diameter_sigma must be 0 or more, and less than"),
        ("--camera 0 --link LINK --fov 60 --color no.npz --marker-color no.npz", "no.npz"),
    ],
)
def test_what_is_missing_is_one_line(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], line: str, words: str
) -> None:
    assert matchset("fly", *line.replace("LINK", LINK).split()) == 2
    out, err = capsys.readouterr()
    assert (out, len(err.splitlines())) == ("", 1), err
    assert words in err


def test_a_file_is_not_flown_by(ball_video: Path) -> None:
    follower = LinkedFollower(camera=str(ball_video), link=LINK, fov_deg=60.0, color=("a",), marker_color=("b",))
    follower.check()
    with pytest.raises(ValueError, match="is a file: nobody can fly by the past"):
        open_camera(follower, None, FlightParameters())
    with pytest.raises(ValueError, match="type: matchset fly sim://chain"):
        open_link("sim://chain", dry=True)


def test_followers_of_a_file_have_whole_paths(tmp_path: Path) -> None:
    path = tmp_path / "flight.toml"
    one = '[[follower]]\ncamera = {}\nlink = "{}"\nfov_deg = 60\ncolor = ["ball.npz"]\nmarker_color = ["marker.npz"]\n'
    path.write_text(one.format(0, LINK) + one.format('"http://a:b@host/x"', "serial:///dev/ttyUSB1"))
    first, second = read_followers(path)
    assert first.color == (str(tmp_path / "ball.npz"),)
    assert first.camera_file == ""
    assert first.words == f"camera 0, {LINK}"
    assert second.words == "http://host/x, serial:///dev/ttyUSB1"
    assert LinkedOptions().followers(None, path) == (first, second)
    check_followers((first, second))
    with pytest.raises(ValueError, match="two followers have the camera 0: each needs its own"):
        check_followers((first, first))
    with pytest.raises(ValueError, match="--fov: of several followers, write it into"):
        LinkedOptions(fov=60.0).followers(None, path)
    with pytest.raises(ValueError, match="--reconnect: of several followers, write it into"):
        LinkedOptions(reconnect=0.0).followers(None, path)
    with pytest.raises(ValueError, match="names the followers already"):
        LinkedOptions(camera="0", link=LINK).followers(None, path)
    assert LinkedOptions().followers("sim://chain", path) == ()


def test_what_is_known_of_camera_and_ball_is_taken_over() -> None:
    typed = LinkedOptions(camera="0", link=LINK, fov=60.0, focal_sigma=0.03, diameter=0.25, diameter_sigma=0.002)
    (follower,) = typed.followers(None, None)
    assert follower.focal_sigma == 0.03
    target = typed.flight(FlightParameters()).pilot.target
    assert (target.diameter, target.diameter_sigma, target.marker_diameter) == (0.25, 0.002, 0.06)
    assert target.markers == ((0.0, 0.0, 1.0),)
    assert LinkedOptions().flight(FlightParameters()) == FlightParameters()


def test_a_wrong_key_of_a_follower_has_its_line(tmp_path: Path) -> None:
    path = tmp_path / "flight.toml"
    path.write_text('[[follower]]\ncamera = 0\nlink = "x"\nfov = 60\n')
    with pytest.raises(ValueError, match=r"flight\.toml, line 4: .*fov"):
        read_followers(path)


def test_the_template_says_what_the_times_of_a_real_flight_are() -> None:
    assert "[flight.linked]" in default_toml()
    for wrong in ({"countdown": -1.0}, {"wait": 0.0}, {"wait": 0.2}, {"silence": 0.01}, {"silence": 100.0}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            LinkedParameters(**wrong)
