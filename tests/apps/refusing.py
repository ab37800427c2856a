"""Checks that the program rejects input: status 2, one line, nothing written."""

import itertools

from program import BOX, WHOLE, ProgramTest, flags, toml

SWEEP = {"depth": 100, "optical_depth": [1, 2], "g": [0, 0.5], "tilts": [0, 0.001]}
COMMANDS = {"covariance": BOX, "validate": BOX, "solve": BOX, "sweep": SWEEP}


class RefusingTest(ProgramTest):
    turns = itertools.count()

    def assert_refused(self, words, *command, **keys):
        before = self.listing()
        done = self.call(*command, **{"out": "new.h5", **keys}, status=2)
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in ["flatspeckle: ", *words]:
            self.assertIn(word, done.stderr)
        self.assertEqual(self.listing(), before, done.stderr)

    def assert_refused_both_ways(self, subcommand, scene, changes, words):
        """Checks flags with a new result file and a scene file with an older result in place; by day cases
        alternate between the two."""
        keys, turn = {**scene, **changes}, next(self.turns) % 2
        if turn == 0 or WHOLE:
            self.assert_refused_as_flags(subcommand, keys, words, changes)
        if turn == 1 or WHOLE:
            self.assert_refused_as_file(subcommand, keys, words, changes)

    def assert_refused_as_flags(self, subcommand, keys, words, changes):
        with self.subTest(subcommand=subcommand, given="flags", changes=changes):
            self.assert_refused(words, subcommand, *flags(keys))

    def assert_refused_as_file(self, subcommand, keys, words, changes):
        with self.subTest(subcommand=subcommand, given="file", changes=changes):
            self.write("scene.toml", toml(keys))
            self.write_older_result("old.h5")
            self.assert_refused(words, subcommand, config="scene.toml", out="old.h5")
