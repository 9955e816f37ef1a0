"""The program ``localshape``, which comes with the package."""

import signal
import sys

from ._core import _program


def main() -> None:
    """Runs the program with the words of the command line."""
    # The program hears Ctrl-C itself.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_program(["localshape", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
