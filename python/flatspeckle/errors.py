"""What can go wrong with a call, as the program tells it."""

import re

LINE = re.compile(r"(?P<key>[\w-]+)(?: = (?P<value>.*?))?(?:: | is not given: )(?P<accepted>.*)", re.DOTALL)


class InputError(ValueError):
    """A key cannot be used: `key`, `value` (a text; None where none was given) and what is `accepted`."""

    def __init__(self, line):
        super().__init__(line)
        found = LINE.fullmatch(line)
        self.key, self.value, self.accepted = found.groups() if found else (None, None, line)


class TargetMissed(UserWarning):
    """A run stopped before its target error; its result is marked (`converged` = 0)."""
