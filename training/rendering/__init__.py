"""Balls rendered before photographs. Read `scene` first.

A ball (`ball`, `light`) or another shape (`other_shapes`), hidden by hands (`hands`) and other things (`covers`),
before a part of a photograph (`photographs`), taken by a bad camera (`camera`); `layers` draws all of them.
Random videos and misleading clicks of the benchmarks are drawn with the same code.
"""
