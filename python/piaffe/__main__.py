"""The command line: what an installed `piaffe` does."""

from __future__ import annotations

import signal
import sys

from . import _piaffe


def main() -> int:
    """Runs what was typed; the exit code."""
    # Nothing of Python runs while the program does: Ctrl-C ends it as it ends any other.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _piaffe.run(["piaffe", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
