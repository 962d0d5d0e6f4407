"""`python -m benchdog`: the command."""

from ._command import main

main()
