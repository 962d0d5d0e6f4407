"""The exceptions of the package."""

from __future__ import annotations

from typing import Optional


class Error(ValueError):
    """An input that is not valid: a file, a text, a dict or an argument. `str()` of it is what the command prints."""

    file: Optional[str]
    """The file; `<text>` or `<dict>` for an input that has no file. `None` for an argument."""
    line: Optional[int]
    """The line of the file or text, from 1, if it is known."""
    key: Optional[str]
    """The key, such as `grip.force_n` or `arms[0].q_rad[3]`, or the argument, if it is known."""
    found: Optional[str]
    """The value that was found, if a value is wrong."""
    expected: Optional[str]
    """The values that are allowed, if a value is wrong."""
    message: str
    """What is wrong, without file, line and key."""

    def __init__(
        self,
        text: str,
        file: Optional[str] = None,
        line: Optional[int] = None,
        key: Optional[str] = None,
        found: Optional[str] = None,
        expected: Optional[str] = None,
        message: Optional[str] = None,
    ) -> None:
        # All of them are arguments of the exception, so that it can be pickled.
        super().__init__(text, file, line, key, found, expected, message)
        self.file, self.line, self.key, self.found, self.expected = file, line, key, found, expected
        self.message = text if message is None else message

    def __str__(self) -> str:
        return str(self.args[0])


class Infeasible(Exception):
    """A scenario has no plan. That is a result and not a wrong input, so it is no `Error`."""

    reason: str
    """Which constraints the candidates broke, and what would help."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason
