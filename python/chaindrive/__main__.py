"""The `chaindrive` command, also as ``python -m chaindrive``.

Ctrl-C ends it with one line and exit code 130 from the first lines of this file to the last. Before
them Python starts, reads its `site` and looks for this package, which takes some 12 ms of an idle
machine: in the first 4 ms Ctrl-C ends the process without a word, and then with a traceback of
Python's own, for nothing of this package has run yet. Nothing was begun in either case.
"""

# Ctrl-C is heard before the core is imported. What is imported before that is in every Python when
# it starts: `signal` takes milliseconds.
import _signal  # type: ignore[import-not-found]
import os
import sys

INTERRUPTED = 130
PROGRAM = 70


def _leave(*_: object) -> None:
    """End at once: nothing was begun."""
    os.write(2, b"interrupted\n")
    os._exit(INTERRUPTED)


# Whoever imports this for something else keeps Ctrl-C as it is. A shell has what it starts in the
# background ignore it, and that is to stay.
_IS_COMMAND = __name__ == "__main__" or sys.argv[0].rpartition(os.sep)[2].startswith("chaindrive")
if _IS_COMMAND and _signal.getsignal(_signal.SIGINT) is _signal.default_int_handler:
    _signal.signal(_signal.SIGINT, _leave)

from chaindrive import _core  # noqa: E402
from chaindrive.signals import hear  # noqa: E402


def _draw(arguments: list[str], source: str, output: str, frames: int | None, *how: bool) -> int:
    """Make what matplotlib and imageio make, and the core does not."""
    from pathlib import Path

    from chaindrive.errors import WriteError

    overwrite, quiet = how
    try:
        # Before packages are imported that take seconds.
        place = _core.NewFile(output, overwrite)
        if arguments[1] == "report":
            from chaindrive import reporting

            return reporting.command(source, Path(output), place, quiet=quiet)
        if arguments[1] == "bench":
            from chaindrive import bench

            return bench.command(lambda: _core._cli(arguments), Path(source), Path(output), place)
        from chaindrive import movies

        return movies.command(source, Path(output), place, frames=frames, quiet=quiet)
    except WriteError as error:
        print(error, file=sys.stderr)
        return 3


def _end(code: int) -> int:
    """Return an exit code that stands: Ctrl-C while Python ends does not change it."""
    if _IS_COMMAND and _signal.getsignal(_signal.SIGINT) is _signal.default_int_handler:
        _signal.signal(_signal.SIGINT, _signal.SIG_IGN)
    return code


def _run(arguments: list[str]) -> int:
    """Run the command of the core; of its table pyarrow makes a stream where that is asked for."""
    for at, argument in enumerate(arguments):
        option, _, value = argument.rpartition("=")
        if (option or arguments[at - 1], value) == ("--format", "arrow"):
            from chaindrive import arrow_stream

            arguments[at] = argument.replace("arrow", "csv")
            return arrow_stream.command(arguments)
    return _core._cli(arguments)


def main() -> int:
    """Run the command line and return its exit code."""
    try:
        if _signal.getsignal(_signal.SIGINT) is _leave:
            _signal.signal(_signal.SIGINT, _signal.default_int_handler)
        hear()
        arguments = ["chaindrive", *sys.argv[1:]]
        if arguments[1:2] == ["fmu"] and not any(it.startswith("--library") for it in arguments):
            from chaindrive.fmu import LIBRARY

            arguments += ["--library", str(LIBRARY)]
        if arguments[1:2] == ["lab"] and not any(it.startswith("--page") for it in arguments):
            from chaindrive.lab_page import PAGE

            if PAGE.is_file():
                arguments += ["--page", str(PAGE)]
        asked = _core._of_measurement(arguments)
        if asked is not None:
            import json

            from chaindrive.measurement.command import command

            return _end(command(asked[0], json.loads(asked[1])))
        drawn = _core._drawn(arguments)
        return _end(_run(arguments) if drawn is None else _draw(arguments, *drawn))
    except KeyboardInterrupt:
        _end(INTERRUPTED)
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    except Exception as error:
        from chaindrive.errors import ProgramError, tell

        if not isinstance(error, ProgramError):
            raise
        tell(error)
        return PROGRAM


if __name__ == "__main__":
    sys.exit(main())
