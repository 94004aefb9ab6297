"""The `chaindrive` command, also as ``python -m chaindrive``."""

import sys

from chaindrive import _core
from chaindrive.signals import hear


def main() -> int:
    """Run the command line and return its exit code."""
    hear()
    return _core._cli(["chaindrive", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
