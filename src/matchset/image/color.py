"""What the target's color is: `ColorModel`, a table from pixel value to how much it looks like the target.

A model holds log-odds L = ``ln p(pixel | target) / p(pixel | background)``; its table holds the whiteness tanh(L / 2),
from -127 (surely background) to 127 (surely target), so Eq. 1 of Epstein & Feldman reads the same with graded
whiteness: white inside minus white outside. BGR pixels are told apart by their 5 upper bits (32 x 32 x 32),
gray ones by their value; a pixel costs one read whatever taught the table.
"""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from matchset.image.brightness import DEFAULT as DEFAULT_BRIGHTNESS
from matchset.image.brightness import BrightnessParameters, Gray, level_in, log_odds_of
from matchset.image.circle_score import Sample, sample_of
from matchset.image.click_region import background_mask, disc_mask, grow_region, regions_at_click, tells
from matchset.image.clicks.reading import REGION, Reading
from matchset.image.color_learning import DEFAULT, ColorParameters, cells_of, features, log_odds_between
from matchset.image.display.png import png_of
from matchset.image.display.swatch import colors_in_words, swatch_of
from matchset.image.files.color_file import ColorFile, read_color, write_color
from matchset.image.frame import Picture, image_of
from matchset.image.hsv_range import hsv_share
from matchset.image.ring import is_ring
from matchset.numeric.arguments import check_kind, check_number
from matchset.numeric.copies import Copied
from matchset.numeric.words import one_line

LIMIT = 4.0  # format: largest log-odds that a table holds, since any one pixel can be wrong
REFUSED = "pick ({:g}, {:g}): {}, nor does anything round stand out there: click elsewhere"  # format: of a refusal
WHITE = 127  # format: table value of a pixel that is surely target, the largest signed byte


class ColorModel(Copied):
    """How much a pixel looks like the target.

    Parameters
    ----------
    log_odds : ndarray of shape (32768,) or (256,), float32
        Log-odds of target against background of each BGR cell ``(b >> 3) << 10 | (g >> 3) << 5 | r >> 3``, or of each
        gray value; clipped to +-4.
    gray : str
        "dark", "light" or "edges" for a model that asks for brightness and suits any picture; empty for a color.

    Attributes
    ----------
    circle : (x, y, radius) or None
        Where a search may begin, px: the reading of the click that was taken.
    alternatives : tuple of Reading
        What the click may mean, the likeliest first: `pick` takes that unless told otherwise, ``reading=2`` takes the
        second. Each has a name ("ball", "spot on it", "ball around it", "another ball", "region"), a circle, px, and
        the log-odds that it was meant. Empty for a model that was not picked; not kept in files.
    sample : Sample or None
        What was around that circle in the picture that was clicked; None of a ring.
    is_local, is_hollow : bool
        Whether it was learned against what is next to the target, since its color is all over; whether that is a ring.
    note : str
        What a user should know of how it was learned; empty if nothing.

    Raises
    ------
    ValueError
        If the table has another size or holds numbers that are not finite.
    """

    def __init__(self, log_odds: npt.NDArray[np.float32], gray: Gray = "") -> None:
        self.gray: Gray = gray
        self.circle: tuple[float, float, float] | None = None
        self.sample: Sample | None = None
        self.is_local, self.is_hollow, self.note = False, False, ""
        self._alternatives: tuple[Reading, ...] = ()
        try:
            values = np.array(log_odds, np.float32)
        except (TypeError, ValueError):
            raise ValueError(f"a color table has 32768 or 256 finite numbers, got {log_odds!r:.60}") from None
        if values.shape not in ((32768,), (256,)) or not np.isfinite(values).all():
            raise ValueError(f"a color table has 32768 or 256 finite numbers, got shape {values.shape}")
        self.log_odds = np.clip(values, -LIMIT, LIMIT)
        self.table = np.rint(WHITE * np.tanh(0.5 * self.log_odds)).astype(np.int8)

    @one_line
    def __repr__(self) -> str:
        return f"ColorModel.{self.gray}()" if self.gray else f"ColorModel({colors_in_words(self.table)})"

    def _repr_png_(self) -> bytes:
        """Show in a notebook which colors, or gray levels, are taken for the target."""
        return png_of(swatch_of(self.scores, bool(self.gray), self.channels))

    @property
    def alternatives(self) -> tuple[Reading, ...]:
        """What the click may mean, the likeliest first."""
        return self._alternatives

    @property
    def channels(self) -> int:
        """3 for color pictures, 1 for gray ones."""
        return 3 if self.table.size == 32768 else 1

    @classmethod
    def learn(
        cls, image: Picture, region: tuple[int, int, int, int], parameters: ColorParameters = DEFAULT
    ) -> "ColorModel":
        """Learn the color from a box inside the target; the rest of the picture teaches the background.

        Parameters
        ----------
        image : ndarray of shape (h, w, 3) or (h, w), uint8, or Frame
        region : tuple of int
            x, y, width, height, px, inside the target.
        parameters : ColorParameters

        Raises
        ------
        ValueError
            If the box is empty or not wholly in the picture, or its color cannot be told from the background.
        """
        image = image_of(image)
        check_kind("parameters", parameters, ColorParameters)
        try:
            x, y, width, height = (round(value) for value in region)
        except (TypeError, ValueError, OverflowError):
            raise ValueError(f"region must be four numbers x, y, width, height, px, got {region!r:.60}") from None
        rows, columns = image.shape[:2]
        if not (width > 0 and height > 0 and x >= 0 and y >= 0 and x + width <= columns and y + height <= rows):
            raise ValueError(f"region {region} does not lie in the {columns} x {rows} picture")
        seed = np.zeros((rows, columns), bool)
        seed[y : y + height, x : x + width] = True
        target = grow_region(features(image, parameters), seed, parameters)
        model = cls._told_apart(image, target, background_mask(target, parameters), parameters)
        if isinstance(model, str):
            raise ValueError(f"region {region}: {model}")
        return model

    @classmethod
    def pick(
        cls,
        image: Picture,
        x: float,
        y: float,
        parameters: ColorParameters = DEFAULT,
        *,
        reading: int = 1,
        ball: bool = True,
    ) -> "ColorModel":
        """Learn the color from one click on the target.

        Parameters
        ----------
        image : ndarray of shape (h, w, 3) or (h, w), uint8, or Frame
        x, y : float
            A point on the target, px.
        parameters : ColorParameters
        reading : int
            Which of the `alternatives` is meant, if it is not the first.
        ball : bool
            Whether a ball may be meant. If not, what grew in color from the click is the target: for other shapes.

        Raises
        ------
        ValueError
            If the point is not in the picture, neither its color nor anything round there stands out, or there is no
            such reading.
        """
        image = image_of(image)
        check_kind("parameters", parameters, ColorParameters)
        for name, number in (("x", x), ("y", y), ("reading", reading)):
            check_number(f"{name} of the pick", number)
        if not (-0.5 <= x < image.shape[1] - 0.5 and -0.5 <= y < image.shape[0] - 0.5):
            raise ValueError(f"pick ({x}, {y}) does not lie in the {image.shape[1]} x {image.shape[0]} picture")
        targets, readings = regions_at_click(image, x, y, parameters if ball else parameters.without_balls(), reading)
        taken = readings[reading - 1]
        model = cls._of_reading(image, targets, taken, parameters)
        if isinstance(model, str):
            raise ValueError(REFUSED.format(x, y, model))
        model.circle, model.sample, model._alternatives = taken.circle, sample_of(image, taken.circle), readings
        if is_ring(model.scores, model.sample):
            model.is_hollow, model.sample = True, None
        return model

    @classmethod
    def _of_reading(
        cls,
        image: npt.NDArray[np.uint8],
        targets: list[npt.NDArray[np.bool_]],
        taken: Reading,
        parameters: ColorParameters,
    ) -> "ColorModel | str":
        """Learn the color of a reading from what may be its pixels, or say why not."""
        found: list[ColorModel] = []
        for target in targets:
            model = cls._told_apart(image, target, background_mask(target, parameters), parameters)
            if taken.name == REGION:
                return model
            if isinstance(model, ColorModel):
                found.append(model)
                if tells(model, image, target, taken.circle, parameters.region):
                    return model
        near = cls._in_its_surroundings(image, targets[-1], taken.circle, parameters)
        disc = disc_mask(image.shape, taken.circle, parameters.region.rim)
        return found[0] if found and not tells(near, image, disc, taken.circle, parameters.region) else near

    @classmethod
    def _in_its_surroundings(
        cls,
        image: npt.NDArray[np.uint8],
        target: npt.NDArray[np.bool_],
        circle: tuple[float, float, float],
        parameters: ColorParameters,
    ) -> "ColorModel":
        """Learn what tells the target from what is next to it, or else follow its outline."""
        outside = background_mask(target, parameters) & disc_mask(target.shape, circle, parameters.surroundings)
        model = cls._told_apart(image, target, outside, parameters)
        how = "learned against what is next to it"
        if isinstance(model, str):
            model, how = cls.edges().for_image(image), "only edges are followed, which is less sure"
        model.is_local = not model.gray
        model.note = f"the color at ({circle[0]:.0f}, {circle[1]:.0f}) is all over the picture: {how}"
        return model

    @classmethod
    def _told_apart(
        cls,
        image: npt.NDArray[np.uint8],
        target: npt.NDArray[np.bool_],
        outside: npt.NDArray[np.bool_],
        parameters: ColorParameters,
    ) -> "ColorModel | str":
        """Learn what tells a target from what is outside; if hardly anything does, the reason in words."""
        if not outside.any():
            return "no background is left to learn from"
        model = cls(log_odds_between(image, target, outside, parameters))
        alike = model.scores(image) > 0
        hits, false = np.mean(alike[target]), np.mean(alike[outside])
        if hits >= parameters.least_hits and false <= parameters.most_false * hits:
            return model
        shares = f"{100 * hits:.0f} % of it stands out, and so does {100 * false:.0f} % of the rest"
        return f"its color cannot be told from the background ({shares})"

    @classmethod
    def hsv(cls, low: tuple[int, int, int], high: tuple[int, int, int]) -> "ColorModel":
        """Color from OpenCV's HSV ranges; a low hue above the high one wraps around red.

        Parameters
        ----------
        low, high : tuple of int
            Hue 0 ... 179, saturation and value 0 ... 255, both ends included.

        Raises
        ------
        ValueError
            If a number is out of its range, or a low saturation or value lies above the high one.
        """
        return cls(3.0 * (2.0 * hsv_share(low, high) - 1.0))

    @classmethod
    def dark(cls) -> "ColorModel":
        """Dark things on light ground, in color or gray pictures: pupils, holes, printed marks.

        How dark is dark follows from each picture: the level that parts it best in two, or, where a tracker is told
        where to `start`, the middle between both sides of that outline.
        """
        return cls(log_odds_of("dark", 127.5, 1), "dark")

    @classmethod
    def light(cls) -> "ColorModel":
        """Light things on dark ground, in color or gray pictures; see `dark`."""
        return cls(log_odds_of("light", 127.5, 1), "light")

    @classmethod
    def edges(cls) -> "ColorModel":
        """Things that differ from the ground somehow, darker here and lighter there: only contrast counts.

        Less sure than any other model, since nothing is asked of the inside: `Tracker.start` says best where it is.
        """
        return cls(log_odds_of("edges", 127.5, 1), "edges")

    def for_image(
        self,
        image: npt.NDArray[np.uint8],
        level: float | None = None,
        parameters: BrightnessParameters = DEFAULT_BRIGHTNESS,
    ) -> "ColorModel":
        """Model for a picture: itself for a color; for brightness with the picture's own level between dark and light.

        Parameters
        ----------
        image : ndarray of shape (h, w, 3), (h, w, 1) or (h, w), uint8
        level : float, optional
            The level, if it is known.
        parameters : BrightnessParameters
            How a level is found and used; a color needs none.

        Raises
        ------
        ValueError
            If a color was learned on another kind of picture.
        """
        if not self.gray:
            self.check(image)
            return self
        channels = 3 if image.ndim == 3 and image.shape[2] == 3 else 1
        same_table = channels == self.channels and self.log_odds[0] == np.float32(parameters.edges_log_odds)
        if self.gray == "edges" and same_table:
            return self
        level = level_in(image, parameters) if level is None else level
        return ColorModel(log_odds_of(self.gray, level, channels, parameters), self.gray)

    def search_models(
        self, image: npt.NDArray[np.uint8], parameters: BrightnessParameters = DEFAULT_BRIGHTNESS
    ) -> "list[ColorModel]":
        """Models by which a search finds candidates: itself, or dark and light where edges are asked for."""
        if self.gray != "edges":
            return [self]
        level, channels = level_in(image, parameters), self.channels
        return [ColorModel(log_odds_of(each, level, channels, parameters), each) for each in ("dark", "light")]

    def __or__(self, other: "ColorModel") -> "ColorModel":
        """Either color: the larger log-odds of the two (Epstein & Feldman, Section 4, filter a)."""
        if not isinstance(other, ColorModel):
            return NotImplemented
        if self.channels != other.channels or self.gray or other.gray:
            raise ValueError("a color and a gray model cannot be joined, nor can models of brightness")
        return ColorModel(np.maximum(self.log_odds, other.log_odds))

    def copy(self) -> "ColorModel":
        """Make a model of its own, so that adapting it leaves this one alone."""
        model = ColorModel(self.log_odds, self.gray)
        model.circle, model.sample, model._alternatives = self.circle, self.sample, self._alternatives
        model.is_local, model.is_hollow, model.note = self.is_local, self.is_hollow, self.note
        return model

    def scores(self, pixels: npt.NDArray[np.uint8]) -> npt.NDArray[np.int8]:
        """Look pixels up in the table: positive where they look like the target.

        Parameters
        ----------
        pixels : ndarray, uint8
            Of the kind that the model was learned on: B, G and R along the last axis, or gray values.
        """
        return np.asarray(self.table[cells_of(pixels, self.table.size)])

    def mask(self, image: Picture) -> npt.NDArray[np.uint8]:
        """Picture of what looks like the target; to look at, the tracking loop never makes one.

        Parameters
        ----------
        image : ndarray of shape (h, w, 3) or (h, w), uint8, or Frame

        Returns
        -------
        ndarray of shape (h, w), uint8
            255 where target, 0 elsewhere.

        Raises
        ------
        ValueError
            If the picture is gray and the model is not, or the other way around.
        """
        image = image_of(image)
        return np.where(self.for_image(image).scores(image) > 0, 255, 0).astype(np.uint8)

    def check(self, image: npt.NDArray[np.uint8]) -> None:
        """Refuse a picture of another kind than the one that was learned (ValueError)."""
        if not self.gray and (3 if image.ndim == 3 and image.shape[2] == 3 else 1) != self.channels:
            kinds = {3: "color", 1: "gray"}
            raise ValueError(
                f"the model was learned on {kinds[self.channels]} pictures, this one is {kinds[4 - self.channels]}"
            )

    def save(self, path: str | Path) -> None:
        """Write the model as a NumPy archive, whole or not at all.

        Parameters
        ----------
        path : str or Path
            Where; the name is taken as it is.
        """
        write_color(Path(path), ColorFile(self.log_odds, self.gray, self.sample, self.is_local, self.is_hollow))

    @classmethod
    def load(cls, path: str | Path) -> "ColorModel":
        """Read a model that `save` wrote.

        Parameters
        ----------
        path : str or Path

        Raises
        ------
        ValueError
            If it is not a color model, or of another version; if there is no such file, also a FileNotFoundError.
        """
        kept = read_color(Path(path))
        try:
            model = cls(kept.log_odds, kept.gray)
        except ValueError as error:
            raise ValueError(f"not a color file: {path} ({error})") from error
        model.sample, model.is_local, model.is_hollow = kept.sample, kept.is_local, kept.is_hollow
        return model
