"""A page on which a person clicks where it is doubtful what the ball is: `ClickPage`."""

from matchset.batch.clicking.clicker import Nobody


class ClickPage(Nobody):
    """Shows doubtful videos as thumbnails, and takes a click for each."""

    def __init__(self, out: str, name: str) -> None:
        self.out, self.name = out, name
