"""What a phone or a web camera does to a picture, and the codec that keeps it.

Read `digital_camera` first: its parameters, and the pipeline from lens to picture. `control_steps` are steps of
automatic exposure and white balance, `processing` what lens, sensor and image processor do to one picture. `codec`
sends a sequence through a video encoder and back: motion JPEG, or H.264 by `h264`.
"""
