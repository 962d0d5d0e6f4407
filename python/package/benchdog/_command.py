"""The command `benchdog`: the same code as that of the program, in this process."""

import sys
from typing import NoReturn

from . import _native


def main() -> NoReturn:
    """Runs the command of `sys.argv` and exits with its exit code."""
    sys.exit(_native.command(sys.argv))
