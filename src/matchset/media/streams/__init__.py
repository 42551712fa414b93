"""What belongs to cameras and streams beside their pictures; those come from `matchset.media.camera_stream`.

Read `silence` (`Silence`: how much of it is borne; `Pauses` between the attempts to open a stream again), `backlog`
(pictures that waited during the opening), `answer` (what an address says that gives no pictures) and `camera_settings`
(exposure, gain, white balance: asked for, read).
"""
