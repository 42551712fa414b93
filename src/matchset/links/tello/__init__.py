"""A DJI or Ryze Tello over its own Wi-Fi, by the text commands of its SDK.

Top down: `tello_link.py` is the link, with what becomes of sticks; `tello_client.py` sends commands and hears answers
and states over UDP; `tello_state.py` reads a state.
"""
