"""Commands for the transmitter, an Arduino with a radio: `matchset radio`.

Read `command` (bind, monitor, test-sticks, config), then `connection` (the link with a clock). `stick_test` moves the
sticks, `config_changes` reads the options of `config`. The protocol is in `matchset/links/arduino`.
"""
