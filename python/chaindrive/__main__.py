"""The `chaindrive` command, also as ``python -m chaindrive``."""

# Before the core hears signals, Ctrl-C ends the command here, without a traceback. What is imported
# before that is in every Python when it starts: `signal` takes milliseconds.
import _signal  # type: ignore[import-not-found]
import os

INTERRUPTED = 130


def _leave(*_: object) -> None:
    """End at once: nothing was begun."""
    os.write(2, b"interrupted\n")
    os._exit(INTERRUPTED)


# A shell has what it starts in the background ignore Ctrl-C, and that is to stay.
if _signal.getsignal(_signal.SIGINT) is _signal.default_int_handler:
    _signal.signal(_signal.SIGINT, _leave)

import sys  # noqa: E402

from chaindrive import _core  # noqa: E402
from chaindrive.signals import hear  # noqa: E402


def _asks_for_a_movie(arguments: list[str]) -> bool:
    """Whether the command line asks for what matplotlib and imageio make, and the core does not."""
    if arguments[:1] != ["replay"] or {"-h", "--help"} & set(arguments):
        return False
    endings = (".mp4", ".gif")
    return any(it in ("--mp4", "--gif") or it.endswith(endings) for it in arguments[1:])


def main() -> int:
    """Run the command line and return its exit code."""
    try:
        if _signal.getsignal(_signal.SIGINT) is _leave:
            _signal.signal(_signal.SIGINT, _signal.default_int_handler)
        hear()
        arguments = sys.argv[1:]
        if _asks_for_a_movie(arguments):
            from chaindrive.movies import command

            return command(arguments)
        if arguments[:1] == ["report"]:
            from chaindrive import reporting

            return reporting.command(arguments)
        return _core._cli(["chaindrive", *arguments])
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
