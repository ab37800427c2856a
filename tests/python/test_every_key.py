"""Every subcommand is a function with all keys of the program's table, their defaults and help, and each key
accepts a value: by night with each subcommand that has it, by day every sixth key with one of them."""

import inspect
import re
import subprocess
import unittest

from package import WHOLE, PackageTest, fs

from flatspeckle import functions, keys, scene

NUMBERS = [1, 0.5, 0, 2, 1e-7, 10, 100, 300, -1]
LENGTHS = (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12)
# Rejections that mean: the value is valid, but this scene does not use it, or the table is that of another key.
UNUSED = re.compile("requires? |is not used here|leave it out|is (a key )?of |column \"g\"")


def candidates(key):
    """Yields values of its kind, to be tried until one is accepted."""
    if key.words:
        singles = [key.words[0]]
    elif key.type is bool:
        singles = [True]
    elif key.type is str:
        singles = ["none", "1.5", "0/2", "render", "g=0:0.5", __file__]
    else:
        singles = [key.type(number) for number in NUMBERS if key.type(number) == number]
    if not key.is_list:
        return singles
    rising = [[key.type(0.1 * first + place) for place in range(count)] for first in (0, 1) for count in LENGTHS
              ] if key.type in (int, float) else []
    return rising + [[one] * count for count in LENGTHS for one in singles]


class EveryKey(PackageTest):
    def refusal(self, subcommand, key, value):
        """Returns the rejection of this value, empty if it is accepted."""
        known = keys.keys_of(subcommand)
        values = scene.all_texts({"out": str(self.folder / "new.h5"), key.name: value}, known)
        words = functions.command(subcommand, values, known, self.folder) + ["--print-config"]
        done = subprocess.run(words, capture_output=True, text=True, timeout=60, cwd=self.folder)
        self.assertIn(done.returncode, (0, 2), done.stderr)
        return "" if done.returncode == 0 else functions.refusal(done.stderr, self.folder)

    def is_understood(self, subcommand, key, value):
        line = self.refusal(subcommand, key, value)
        self.assertNotIn("unknown key", line)
        return not line or fs.InputError(line).key != key.name or UNUSED.search(line)

    def check_value(self, subcommand, key):
        with self.subTest(subcommand=subcommand, key=key.name):
            if key.name != "out":
                table = self.folder / "table.csv"  # for keys that name a table
                table.write_text("g\n0\n0.5\n")
                values = [*candidates(key), str(table)] if key.type is str and not key.is_list else candidates(key)
                self.assertTrue(any(self.is_understood(subcommand, key, value) for value in values))

    def test_each_key_takes_a_value(self):
        every = [(subcommand, key) for subcommand in functions.subcommands() for key in keys.keys_of(subcommand).values()]
        one_of_each = {(key.name, key.type, key.is_list): (subcommand, key) for subcommand, key in every}
        for subcommand, key in every if WHOLE else list(one_of_each.values())[::6]:
            self.check_value(subcommand, key)

    def test_each_key_is_described(self):
        for subcommand in functions.subcommands():
            function = getattr(fs, subcommand)
            parameters = inspect.signature(function).parameters
            text = re.sub(r"\s+", " ", function.__doc__)
            for name, key in keys.keys_of(subcommand).items():
                with self.subTest(subcommand=subcommand, key=name):
                    self.assertEqual(parameters[name].default, key.default)
                    for part in (name, key.unit, key.accepted, *key.helps):
                        self.assertIn(re.sub(r"\s+", " ", part), text)

    def test_all_but_lists_of_keys_are_functions(self):
        printed = subprocess.run([fs.program.path(), "--help"], capture_output=True, text=True).stdout
        named = set(re.findall(r"^  (\w+)  ", printed, re.MULTILINE))
        self.assertEqual(set(functions.subcommands()), named - {"bench", "keys", "datasets", "explain", "export", "new"})

    def test_no_key_is_hidden_by_a_word_of_python(self):
        for subcommand in functions.subcommands():
            self.assertFalse({"cache", "progress", "scene"} & set(keys.keys_of(subcommand)), subcommand)


if __name__ == "__main__":
    unittest.main()
