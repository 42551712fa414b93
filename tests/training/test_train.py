"""How the network of discs is learned, where PyTorch is: the package and its tests do without."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")

import torch
from training.augmentation import AugmentationParameters, varied
from training.examples import Examples
from training.silent import with_silent

from matchset.image.disc_network.network import FILE, DiscNetwork
from training import train

SMALL = train.NetworkParameters(width=12)


def patches_of(seed: int, count: int) -> torch.Tensor:
    return torch.from_numpy(np.random.default_rng(seed).normal(0.0, 0.7, (count, 64, 32, 6)).astype(np.float32))


def as_the_package_sees(network: train.Network, path: Path) -> DiscNetwork:
    train.export(network, path)
    with np.load(path) as file:
        return DiscNetwork({name: file[name] for name in file.files})


@pytest.mark.parametrize("width", [12, 96])
def test_the_package_sees_what_the_network_in_pytorch_sees(width: int, tmp_path: Path) -> None:
    torch.manual_seed(width)
    network = train.Network(train.NetworkParameters(width=width)).half().float()  # as it is exported
    package, patches = as_the_package_sees(network, tmp_path / "weights.npz"), patches_of(1, 6)
    with torch.no_grad():
        output = network(patches)
    for index, patch in enumerate(patches.numpy()):
        seen = package.see(patch)
        assert output.step[index].numpy() == pytest.approx(seen.step, abs=2e-5)
        assert output.precision[index].numpy() == pytest.approx(seen.precision, rel=1e-4, abs=2e-3)
        assert float(output.log_odds[index]) == pytest.approx(seen.log_odds, abs=2e-5)


def test_weights_of_the_package_can_be_begun_with_and_are_exported_as_they_were() -> None:
    network = train.Network()
    train.begin_with(network, FILE)
    with np.load(FILE) as file:
        kept, exported = with_silent({name: file[name] for name in file.files}), train.weights_of(network)
        assert set(kept) == set(exported)
        assert all(np.array_equal(kept[name], exported[name]) for name in kept)


def test_weights_of_fewer_numbers_of_a_place_are_those_of_the_first_ones(tmp_path: Path) -> None:
    one, other, patches = train.Network(SMALL), train.Network(SMALL), patches_of(4, 3)
    state = one.state_dict()
    state["first.weight"] = state["first.weight"].reshape(-1, 32, 6)[..., :5].reshape(len(state["first.weight"]), -1, 1)
    torch.save(state, tmp_path / "five.pt")
    train.begin_with(other, tmp_path / "five.pt")
    patches[..., 5] = 0.0
    with torch.no_grad():
        assert torch.allclose(one(patches).step, other(patches).step, atol=1e-5)


def test_a_wider_network_goes_on_from_a_narrower_one(tmp_path: Path) -> None:
    narrow, wide = train.Network(SMALL), train.Network(train.NetworkParameters(width=20))
    torch.save(narrow.state_dict(), tmp_path / "narrow.pt")
    train.begin_with(wide, tmp_path / "narrow.pt")
    with torch.no_grad():
        before, after = narrow(patches_of(3, 4)), wide(patches_of(3, 4))
    for one, other in zip(before, after, strict=True):
        assert torch.allclose(one, other, rtol=1e-4, atol=1e-4)
    targets = torch.tensor([[0.1, 0.0, 0.1, 1.0]] * 4)
    train.loss_of(wide(patches_of(3, 4)), targets, train.LearningParameters()).backward()
    assert float(wide.a.weight.grad[:12, 12:].abs().max()) > 0.0  # what is new comes to count


def test_a_state_can_be_begun_with(tmp_path: Path) -> None:
    one, other = train.Network(SMALL), train.Network(SMALL)
    torch.save(one.state_dict(), tmp_path / "one.pt")
    train.begin_with(other, tmp_path / "one.pt")
    with torch.no_grad():
        assert torch.equal(one(patches_of(2, 3)).step, other(patches_of(2, 3)).step)


def test_turned_and_mirrored_rays_lead_where_they_did() -> None:
    """A patch that is a bump in the direction of its target stays one."""
    angles = 2.0 * np.pi * np.arange(64) / 64
    targets = torch.tensor([[0.3, -0.2, 0.1, 1.0], [-0.1, 0.25, 0.0, 1.0]])
    chance = torch.Generator().manual_seed(3)
    for _ in range(12):
        right, down = targets[:, :1].numpy(), targets[:, 1:2].numpy()
        along = (right * np.cos(angles) + down * np.sin(angles)).astype(np.float32)
        patches = torch.zeros((2, 64, 32, 6))
        patches[..., 4] = torch.from_numpy(along)[:, :, None]
        new, moved = varied(patches, targets, chance, AugmentationParameters())
        right, down = moved[:, :1].numpy(), moved[:, 1:2].numpy()
        assert new[:, :, 0, 4].numpy() == pytest.approx(right * np.cos(angles) + down * np.sin(angles), abs=1e-5)
        assert torch.equal(moved[:, 2:], targets[:, 2:])


def test_colors_known_beforehand_are_left_out_of_some_examples() -> None:
    patches, targets = torch.ones((200, 64, 32, 6)), torch.zeros((200, 4))
    new, _ = varied(patches, targets, torch.Generator().manual_seed(1), AugmentationParameters(unknown=0.5))
    unknown = (new[..., 5] == 0.0).all(dim=2).all(dim=1)
    assert 70 < int(unknown.sum()) < 130
    assert not bool((new[..., 3] == 0.0).any())


def test_the_loss_is_least_at_the_target() -> None:
    limits, precision = train.LearningParameters(), 100.0 * torch.eye(3).expand(2, 3, 3)
    targets = torch.tensor([[0.1, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 0.0]])
    odds = torch.tensor([2.0, -2.0])

    def loss(step: float, log_odds: torch.Tensor) -> float:
        told = torch.tensor([[step, 0.0, 0.0], [9.0, 9.0, 9.0]])
        return float(train.loss_of(train.Output(told, precision, log_odds), targets, limits))

    assert loss(0.1, odds) < min(loss(0.05, odds), loss(0.15, odds), loss(0.1, -odds))


def test_a_network_learns_and_is_judged_on_what_it_has_not_seen() -> None:
    random = np.random.default_rng(0)
    there = (random.random(400) < 0.5).astype(np.float32)
    patches = random.normal(0.0, 0.3, (400, 64, 32, 6)).astype(np.float16)
    patches[..., 3] += (there[:, None, None] * np.where(np.arange(32) < 16, 1.0, -1.0)).astype(np.float16)
    targets = np.zeros((400, 4), np.float32)
    targets[:, 3] = there
    limits = train.LearningParameters(network=SMALL, batch=32, first_steps=5)
    score = train.train(Examples(patches, targets), 400, train.Learner(limits), limits)
    assert score.area > 0.95
    assert "false at 10 % missed" in str(score)


def test_too_few_examples_are_an_error() -> None:
    with pytest.raises(ValueError, match="a step needs 256"):
        train.held_back(200, train.LearningParameters())
