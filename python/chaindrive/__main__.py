"""The `chaindrive` command, also as ``python -m chaindrive``."""

import sys

from chaindrive import _core
from chaindrive.signals import hear


def _asks_for_a_movie(arguments: list[str]) -> bool:
    """Whether the command line asks for what matplotlib and imageio make, and the core does not."""
    if arguments[:1] != ["replay"] or {"-h", "--help"} & set(arguments):
        return False
    endings = (".mp4", ".gif")
    return any(it in ("--mp4", "--gif") or it.endswith(endings) for it in arguments[1:])


def main() -> int:
    """Run the command line and return its exit code."""
    hear()
    arguments = sys.argv[1:]
    if _asks_for_a_movie(arguments):
        from chaindrive.movies import command

        return command(arguments)
    return _core._cli(["chaindrive", *arguments])


if __name__ == "__main__":
    sys.exit(main())
