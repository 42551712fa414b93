"""A camera with RTSP on loopback: GStreamer's own server, a blue ball before a gray wall.

A program of its own, for Debian's Python, which has GStreamer: rtsp_camera.py PORT. It prints the port (0: a free one).
"""

import sys
from typing import Any

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstRtspServer  # noqa: E402 - as its versions must be named first

SOURCE = (
    "videotestsrc is-live=true pattern=ball foreground-color=0xff1e46be background-color=0xff969696 "
    "! video/x-raw,format=I420,width=320,height=240,framerate=30/1"
)
ENCODERS = {
    "x264enc": "x264enc tune=zerolatency speed-preset=ultrafast key-int-max=15 ! rtph264pay config-interval=-1",
    "openh264enc": "openh264enc gop-size=15 ! rtph264pay config-interval=-1",
    "jpegenc": "jpegenc ! rtpjpegpay",
}


def main() -> None:
    """Serve until killed."""
    Gst.init(None)
    encoder = next(words for name, words in ENCODERS.items() if Gst.ElementFactory.find(name) is not None)
    factory: Any = GstRtspServer.RTSPMediaFactory()
    factory.set_launch(f"( {SOURCE} ! {encoder} name=pay0 pt=96 )")
    factory.set_shared(True)
    server: Any = GstRtspServer.RTSPServer()
    server.set_address("127.0.0.1")
    server.set_service(sys.argv[1])
    server.get_mount_points().add_factory("/ball", factory)
    if not server.attach(None):
        sys.exit(f"cannot listen on port {sys.argv[1]}")
    print(server.get_bound_port(), encoder.partition(" ")[0], flush=True)
    GLib.MainLoop().run()


if __name__ == "__main__":
    main()
