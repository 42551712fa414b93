"""The command `matchset batch`. This module is loaded for every `matchset --help`."""

from matchset.app.several.options import check_several
from matchset.batch.options import BatchOptions

BATCH_EPILOG = r"""
[bold]Examples[/bold]

  matchset batch clips --out results --color ball.npz

  matchset batch clips --out results --auto --page

  matchset batch 'day1/*.mp4' 'day2/*.mp4' --out results --clicks clicks.csv --jobs 4

  matchset batch clips --out results --color ball.npz --all --most 8

  matchset batch list.txt --out results --locate --camera camera.toml --diameter 0.22 --color ball.npz

  matchset batch clips --out /mnt/lab/results --auto --scheduler tcp://10.0.0.5:8786

Each video has a folder in DIR with the tables of 'track' or 'locate'. manifest.jsonl holds a line for each that has
ended: the same command goes on where it was stopped. videos.csv has a row for each video, all.csv all their rows,
summary.html how much was found, and the worst with pictures.

Exit codes: 0 done, 1 some video failed, is doubtful, or shows no ball, 2 bad input or options, 3 the scheduler went
away, 130 stopped by Ctrl-C (files are whole; the same command goes on).
"""


def batch(options: BatchOptions) -> int:
    """Follow or locate balls in thousands of videos, by all processors or many computers; stop it, it goes on."""
    check_several_of(options)
    from matchset.batch.run import run_batch

    return run_batch(options)


def check_several_of(options: BatchOptions) -> None:
    """Check the options for several targets (ValueError)."""
    from matchset.batch.jobs.video_options import track_options

    check_several(track_options(options, "a video"))
