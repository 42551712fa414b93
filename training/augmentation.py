"""Examples as they could have been too: turned, mirrored, of other colors, with weaker log-odds: `varied`."""

import math

import msgspec
import torch

from matchset.image.disc_network.patch_format import RAYS

LIGHTNESS, GREEN_RED, BLUE_YELLOW, LOG_ODDS, SEEN, KNOWN = range(6)  # numbers of a place, as `polar_patch` orders them


class AugmentationParameters(msgspec.Struct, frozen=True):
    """How examples are varied; chosen by hand.

    Parameters
    ----------
    mirrored : float
        Share of batches that are.
    scale : float
        Standard deviation of the logarithm by which lightness and, apart from it, both other colors are multiplied.
    inverted : float
        Share of examples whose light is dark and whose dark is light.
    weakened : float
        Share whose log-odds of colors are multiplied by a number between 0 and 1.
    unknown : float
        Share of which no colors are known beforehand.
    """

    mirrored: float = 0.5
    scale: float = 0.15
    inverted: float = 0.15
    weakened: float = 0.1
    unknown: float = 0.3


def varied(
    patches: torch.Tensor, targets: torch.Tensor, chance: torch.Generator, limits: AugmentationParameters
) -> tuple[torch.Tensor, torch.Tensor]:
    """Vary a batch of examples.

    Parameters
    ----------
    patches : Tensor of shape (n, 64, 32, 6)
    targets : Tensor of shape (n, 4)
    chance : Generator
    limits : AugmentationParameters

    Returns
    -------
    (Tensor, Tensor)
        New patches and targets.
    """
    patches, targets = _turned(patches, targets, int(torch.randint(RAYS, (), generator=chance)))
    if float(torch.rand((), generator=chance)) < limits.mirrored:
        patches, targets = _mirrored(patches, targets)
    return _recolored(patches, chance, limits), targets


def _turned(patches: torch.Tensor, targets: torch.Tensor, rays: int) -> tuple[torch.Tensor, torch.Tensor]:
    """Turn a batch by so many rays, from x toward y."""
    angle = 2.0 * math.pi * rays / RAYS
    right, down, larger, there = targets.unbind(1)
    x = math.cos(angle) * right - math.sin(angle) * down
    y = math.sin(angle) * right + math.cos(angle) * down
    return torch.roll(patches, rays, 1), torch.stack((x, y, larger, there), 1)


def _mirrored(patches: torch.Tensor, targets: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Turn a batch upside down."""
    return torch.roll(torch.flip(patches, (1,)), 1, 1), targets * torch.tensor((1.0, -1.0, 1.0, 1.0))


def _recolored(patches: torch.Tensor, chance: torch.Generator, limits: AugmentationParameters) -> torch.Tensor:
    """Turn the plane of hues, scale the colors, invert the lightness, weaken the log-odds: each example by itself."""
    each = (len(patches), 1, 1)
    hue = 2.0 * math.pi * torch.rand(each, generator=chance)
    light, vivid = (torch.exp(limits.scale * torch.randn(each, generator=chance)) for _ in range(2))
    light = torch.where(torch.rand(each, generator=chance) < limits.inverted, -light, light)
    weakened = torch.rand(each, generator=chance) < limits.weakened
    weak = torch.where(weakened, torch.rand(each, generator=chance), torch.ones(()))
    first, second = patches[..., GREEN_RED], patches[..., BLUE_YELLOW]
    recolored = patches.clone()
    recolored[..., LIGHTNESS] = patches[..., LIGHTNESS] * light
    recolored[..., GREEN_RED] = (torch.cos(hue) * first - torch.sin(hue) * second) * vivid
    recolored[..., BLUE_YELLOW] = (torch.sin(hue) * first + torch.cos(hue) * second) * vivid
    recolored[..., LOG_ODDS] = patches[..., LOG_ODDS] * weak
    known = torch.rand(each, generator=chance) >= limits.unknown
    recolored[..., KNOWN] = patches[..., KNOWN] * weak * known
    return recolored
