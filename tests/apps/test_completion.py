"""Shell completion and manual page from the key tables: bash and zsh complete subcommands and their flags, and the
manual page has no warnings."""

import re
import shutil
import subprocess
import unittest

from program import PROGRAM


def completed(*words):
    """Returns the completions of the last word by bash."""
    script = (f'source <("{PROGRAM}" keys completion); COMP_WORDS=(flatspeckle "$@"); COMP_CWORD=$#; '
              '_flatspeckle || true; echo "${COMPREPLY[@]}"')
    return subprocess.run(["bash", "-euc", script, "bash", *words], capture_output=True, text=True,
                          check=True).stdout.split()


class Completion(unittest.TestCase):
    def test_subcommands(self):
        self.assertEqual(completed("cov"), ["covariance"])
        self.assertIn("render", completed("re"))

    def test_flags_of_a_subcommand(self):
        self.assertEqual(completed("covariance", "--opt"), ["--optical_depth"])
        self.assertEqual(completed("trace", "--optical"), [])


ZSH = """
compadd() { shift; print -l -- $@ }
_files() { : }
words=(flatspeckle $@); CURRENT=$(( $# + 1 ))
eval "$("$PROGRAM" keys zsh)"
"""


@unittest.skipUnless(shutil.which("zsh"), "no zsh here")
class Zsh(unittest.TestCase):
    def offered(self, *words):
        return subprocess.run(["zsh", "-fc", ZSH, "zsh", *words], capture_output=True, text=True, check=True,
                              env={"PROGRAM": PROGRAM}).stdout.split()

    def test_subcommands_and_flags(self):
        self.assertIn("covariance", self.offered("cov"))
        self.assertIn("--optical_depth", self.offered("covariance", "--opt"))
        self.assertNotIn("--optical_depth", self.offered("trace", "--opt"))


class Manual(unittest.TestCase):
    def test_is_clean(self):
        page = subprocess.run([PROGRAM, "keys", "man"], capture_output=True, text=True, check=True).stdout
        for text in (".SH flatspeckle covariance\n", "\\fB\\-\\-optical_depth\\fR FLOAT\n", ".SH EXIT STATUS"):
            self.assertIn(text, page)
        if shutil.which("groff"):
            shown = subprocess.run(["groff", "-man", "-Tutf8", "-ww"], input=page, capture_output=True, text=True)
            self.assertEqual((shown.returncode, shown.stderr), (0, ""))
            self.assertTrue("--optical_depth" in re.sub(".\x08", "", shown.stdout))


if __name__ == "__main__":
    unittest.main()
