"""docs/keys.md is what `flatspeckle keys markdown` prints below its introduction. With --update
it writes that text there."""

import subprocess
import sys
import unittest

from program import DATA, PROGRAM

DOCUMENT = DATA.parent / "docs" / "keys.md"
MARK = "<!-- printed by: flatspeckle keys markdown -->\n"


def printed():
    return subprocess.run([PROGRAM, "keys", "markdown"], capture_output=True, text=True, check=True).stdout


class KeysTest(unittest.TestCase):
    def test_document(self):
        tables = DOCUMENT.read_text().split(MARK)[1]
        self.assertEqual(tables, printed(), "put what `flatspeckle keys markdown` prints there (--update)")


def update():
    DOCUMENT.write_text(DOCUMENT.read_text().split(MARK)[0] + MARK + printed())


if __name__ == "__main__":
    update() if sys.argv[1:] == ["--update"] else unittest.main()
