"""The page of batches: its script for SLURM runs with a stand-in for `srun`, its file for Kubernetes is well-formed."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer
import yaml

from batched_videos import write_balls, write_color
from matchset.batch.workers.worker import THREADS
from matchset.cli import app

PAGE = Path(__file__).resolve().parents[2] / "docs" / "batch.md"
LONGEST = 240.0  # s, far more than it takes


def blocks(language: str) -> list[str]:
    found = re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert found
    return found


def options_of(words: list[str]) -> set[str]:
    """Options among words, which must be those of `matchset batch`."""
    command: Any = typer.main.get_command(app)
    known = {name for parameter in command.commands["batch"].params for name in parameter.opts}
    used = {word.split("=")[0] for word in words if word.startswith("--")}
    assert used <= known, used - known
    return used


def program(folder: Path, name: str, line: str) -> None:
    """Write a program of one line."""
    path = folder / name
    path.write_text(f"#!/bin/sh\n{line}\n")
    path.chmod(0o755)


@pytest.mark.timeout(600)
@pytest.mark.skipif(sys.platform == "win32", reason="a script for bash")
def test_the_script_for_slurm(tmp_path: Path) -> None:
    pytest.importorskip("distributed", reason="Dask is not installed (extra batch)")
    clips = write_balls(tmp_path / "clips", 4)
    write_color(tmp_path / "ball.npz")
    programs, here = tmp_path / "bin", shlex.quote(sys.executable)
    programs.mkdir()
    program(programs, "srun", 'exec "$@"')
    program(programs, "hostname", "echo 127.0.0.1")
    for name in ("dask", "matchset"):
        program(programs, name, f'exec {here} -m {name} "$@"')
    (script,) = (block for block in blocks("bash") if "#SBATCH" in block)
    environment = {**os.environ, **dict.fromkeys(THREADS, "1"), "PATH": f"{programs}:{os.environ['PATH']}"}
    environment |= {"SLURM_JOB_ID": str(os.getpid()), "SLURM_CPUS_PER_TASK": "2"}
    words = ["bash", "-c", script]
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=LONGEST)
    assert done.returncode == 0, done.stdout + done.stderr
    tables = {path.parent.name for path in (tmp_path / "results").rglob("tracks.csv")}
    assert tables == {path.name for path in clips.rglob("*.mp4")}


@pytest.mark.skipif(sys.platform == "win32", reason="scripts for bash")
@pytest.mark.parametrize("script", blocks("bash"))
def test_scripts_are_well_formed(script: str) -> None:
    subprocess.run(["bash", "-n", "-c", script], check=True)


def test_the_file_for_kubernetes() -> None:
    (text,) = blocks("yaml")
    parts = list(yaml.safe_load_all(text))
    assert [part["kind"] for part in parts] == ["Service", "Deployment", "Deployment", "Job", "NetworkPolicy"]
    service, scheduler, worker, job, policy = parts
    assert service["spec"]["selector"].items() <= scheduler["spec"]["template"]["metadata"]["labels"].items()
    for part in (scheduler, worker):
        labels = part["spec"]["template"]["metadata"]["labels"]
        assert part["spec"]["selector"]["matchLabels"].items() <= labels.items()
    reached = policy["spec"]["podSelector"]["matchLabels"].items()
    for part in (scheduler, worker, job):
        spec = part["spec"]["template"]
        assert reached <= spec["metadata"]["labels"].items()
        mounted = {
            each["name"] for container in spec["spec"]["containers"] for each in container.get("volumeMounts", [])
        }
        assert mounted == {each["name"] for each in spec["spec"].get("volumes", [])}
        for container in spec["spec"]["containers"]:
            assert all(isinstance(word, str) for word in [*container["command"], *container.get("args", [])])
    (batch,) = job["spec"]["template"]["spec"]["containers"]
    assert batch["command"][:2] == ["matchset", "batch"]
    assert options_of([*batch["command"], *batch["args"]]) == {"--out", "--color", "--scheduler"}
    (works,) = worker["spec"]["template"]["spec"]["containers"]
    port = service["spec"]["ports"][0]["port"]
    address = f"tcp://{service['metadata']['name']}:{port}"
    assert address in works["command"]
    assert address in batch["args"]
