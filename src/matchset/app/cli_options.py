"""Options that several commands share, as `typer` wants them."""

from pathlib import Path
from typing import Annotated

import typer

Source = Annotated[
    str, typer.Argument(help="A video file, a picture, a folder of pictures, a camera's number, or a URL.")
]
Force = Annotated[bool, typer.Option("--force", help="Overwrite what exists.")]
Pick = Annotated[str | None, typer.Option(metavar="X,Y[@FRAME]", help="A pixel on the ball, in frame 0 or FRAME.")]
Candidate = Annotated[
    str | None, typer.Option(metavar="N[@FRAME]", help="The ball-like thing that 'learn' numbered N.")
]
Color = Annotated[
    list[Path] | None,
    typer.Option(metavar="FILE", help="A color of the ball that 'learn' saved; several are joined."),
]
Hsv = Annotated[
    list[str] | None,
    typer.Option(
        metavar="LOW:HIGH",
        help="OpenCV's HSV range H,S,V:H,S,V; a low hue above the high one wraps at red.",
    ),
]
Gray = Annotated[
    str | None,
    typer.Option(metavar="dark|light|edges", help="Brightness in place of color; a --pick then says where."),
]
ShapeName = Annotated[
    str,
    typer.Option(
        "--shape",
        metavar="SHAPE",
        help="circle, ellipse, rectangle, quadrilateral, triangle, hexagon, octagon, corners '0,0 4,0 0,3', "
        "or a picture of the outline; ':affine' behind it: seen from the side.",
    ),
]
AnnotatedVideo = Annotated[
    Path | None,
    typer.Option(
        "--video", metavar="OUT.mp4", help="Write the annotated video: .mp4 (VP9), or .webm (20 times as fast)."
    ),
]
Folder = Annotated[Path | None, typer.Option("-o", metavar="DIR", help="Folder for the tables.")]
ToStdout = Annotated[
    bool, typer.Option("--print", help="Write one line of JSON a frame to stdout, and nothing else there.")
]
Points = Annotated[int, typer.Option(min=16, max=4096, help="Size of the match-set: more is steadier and slower.")]
