"""Runs ``python -m addon``: `compute`, `evaluate` and other commands, with Blender as a module or without it."""

import sys
from collections.abc import Sequence


def main(words: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    words : sequence of str, optional
        The arguments; those of this process if omitted.

    Returns
    -------
    int
        The exit code.
    """
    words = sys.argv[1:] if words is None else words
    if words[:1] == ["evaluate"]:
        from .evaluation.command import main as evaluate

        return evaluate(list(words[1:]))
    if words[:1] == ["evaluate-matches"]:
        from .evaluation.correspondences.command import main as evaluate_matches

        return evaluate_matches(list(words[1:]))
    if words[:1] == ["evaluate-rigs"]:
        from .evaluation.rigs.command import main as evaluate_rigs

        return evaluate_rigs(list(words[1:]))
    from .batch.command import main as run

    return run(words, sys.stdout)


if __name__ == "__main__":
    sys.exit(main())
