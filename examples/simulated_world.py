"""Two simulated vehicles: a camera on the first one measures the second one, which swings on a rope. No file needed."""

import math

import matchset as ms

camera = ms.CameraModel.from_fov(640, 480, math.radians(90))
world = ms.sim.World(ms.sim.ChainParameters(vehicles=2), seed=7)
cameras = ms.sim.WorldCameras(world, camera, preset="typical")

sample = cameras.held_ball(0)  # a ball 1 m before the camera, its marker in the middle of the picture
marker_color = ms.ColorModel.pick(sample, 319.5, 239.5, reading=2)  # a spot on the ball
color = ms.ColorModel.pick(sample, 280.0, 239.5) | marker_color
target = ms.BallTarget(diameter=0.28, markers=((0, 0, 1),), marker_diameter=0.06)
tracker, markers = ms.Tracker(ms.Circle, color), ms.MarkerTracker(marker_color, target)
localizer = ms.Localizer(camera, target)

for index in range(30):
    taken = index * ms.sim.RATE // 30  # the world counts steps of 1/480 s
    world.advance(taken + 4)  # the second field of a picture is exposed 4 steps after its middle
    frame = ms.Frame(cameras.image(0, taken), taken / ms.sim.RATE, index)
    ball = tracker.update(frame)
    pose = localizer.update(ball, markers.update(frame, ball))
    if isinstance(pose, ms.Lost):
        print(f"{index:3d}  lost: {pose.reason}")
        continue
    me, neighbor = world.poses(taken)  # the truth
    truth = (neighbor.ball - ms.sim.camera_position(me)) @ me.rotation
    off_mm = 1000.0 * math.dist(pose.position, truth)
    x, y, z = pose.position
    print(f"{index:3d}  x {x:+.3f}  y {y:+.3f}  z {z:.3f} m  off {off_mm:.0f} mm")
