"""Errors and warnings raised by calls, made from the messages of the program."""

import re

LINE = re.compile(r"(?P<key>[\w-]+)(?: = (?P<value>.*?))?(?:: | is not given: )(?P<accepted>.*)", re.DOTALL)


class InputError(ValueError):
    """Raised for a key that cannot be used. Attributes: `key`, `value` (a text, or None if not given), and
    `accepted`, a text that describes the accepted values."""

    def __init__(self, line):
        super().__init__(line)
        found = LINE.fullmatch(line)
        self.key, self.value, self.accepted = found.groups() if found else (None, None, line)


class TargetMissed(UserWarning):
    """Warning that a run stopped before it reached its target error; its result has `converged` = 0."""
