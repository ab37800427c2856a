#!/usr/bin/env python3
"""Plain words: comments begin as sentences, names and messages use the field's terms, guides have short sentences.

Run as a program it prints the length of the sentences of each page; with paths, also what the lint finds in them.
"""

import re
import sys
import tempfile
import unittest
from pathlib import Path

from test_modules import CODE, ROOT, sources

FIRST = re.compile(r"(?:Of|That|Those|As|Nothing|The same|So|Or|And|What)\b")
# The glossary's left column, by parts of names (left_out, LeftOut) and words of messages.
NAMES = set("""joined joins way ways worth worthwhile outlook pull pulls pulled stretch stretched stretches promise
    promises promised family families lone rival rivals analog refind refinds chance chances slope slopes sloped fate
    fates leg legs passage passages hollow hollows unmixing stranger strangers sealed room rooms house seldom dear
    luck dies""".split())
MESSAGES = NAMES - {"family", "lone", "legs", "slope", "slopes", "analog", "unmixing", "refind", "way", "ways"} | {
    "books", "outlook"}
# Where a word has its plain sense: {word: parts of paths}.
PLAIN = {
    "slope": ["bench/error/", "bench/command/bench",  # of straight lines in log-log plots
              "grin/media/fields/linear_ramp",  # of a linear index, as the key
              "grin/trace/trace_"],  # of a ray, as the dataset
    "slopes": ["bench/error/"],
    # Names of rows, which the report quotes.
    "promise": ["bench/plan/plan_mc"],
    "joins": ["bench/plan/plan_rays", "bench/stability/"],
    "stretched": ["bench/stability/"],
    "chance": ["bench/stability/"],
}
TOKEN = re.compile(r'R"(\w*)\((.*?)\)\1"|//[^\n]*|/\*.*?\*/|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.)+\'|[A-Za-z_]\w*',
                   re.DOTALL)
PARTS = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
LINE_START = re.compile(r"^[ \t]*(///?)[ \t]+(\S.*)$")
WORDS, AVERAGE = 30, 18


def line_of(text, at):
    return text.count("\n", 0, at) + 1


def is_plain(word, file):
    return any(part in str(file) for part in PLAIN.get(word, ()))


def fragments(text):
    """(line, comment) of comments whose first words begin no sentence."""
    block = False
    for number, line in enumerate(text.split("\n"), 1):
        match = LINE_START.match(line)
        if match and not block and FIRST.match(match[2]):
            yield number, match[2]
        block = line.lstrip().startswith("//")


def home_made(text, file):
    """(line, word) of the glossary's left column in names and messages."""
    for match in TOKEN.finditer(text):
        token = match[0]
        if token.startswith("/") or re.match(r"#include.*$", text[text.rfind("\n", 0, match.start()) + 1:match.end()]):
            continue
        is_message = token[0] in "\"'R" and token[-1] in "\"'"
        if is_message and " " not in token:
            continue  # keys, datasets and formats are what users have
        words = re.findall(r"[a-z]+", token.lower()) if is_message else [p.lower() for p in PARTS.findall(token)]
        for word in words:
            if word in (MESSAGES if is_message else NAMES) and not is_plain(word, file):
                yield line_of(text, match.start()), f"{word}: {token[:60]}"


def sentences(markdown):
    """The sentences of a page without its code, tables, figures and headings."""
    text = re.sub(r"```.*?```", "", markdown, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    blocks, block = [], []
    for line in text.split("\n"):
        line = line.strip()
        is_item = re.match(r"(?:[-*]|\d+\.) ", line)
        if not line or line[0] in "|#!<" or is_item:
            blocks.append(" ".join(block))
            block = []
        if line and line[0] not in "|#!<":
            block.append(re.sub(r"^(?:[-*]|\d+\.) ", "", line))
    blocks.append(" ".join(block))
    for text in blocks:
        text = re.sub(r"`[^`]*`", "code", text)
        text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
        for sentence in re.split(r"(?<=[.!?])[)\"*_]*\s+(?=[A-Z`*\"(\d]|code)", text):
            if re.search(r"[A-Za-z]", sentence):
                yield sentence.strip()


def lengths(markdown):
    return [len(re.findall(r"[A-Za-z][\w'-]*", sentence)) for sentence in sentences(markdown)]


def pages(root):
    generated = {"docs/format.md", "docs/keys.md", "docs/report/report.md"}
    found = [root / "README.md", *sorted((root / "docs").glob("*.md"))]
    return [page for page in found if str(page.relative_to(root)) not in generated]


def code_files(root):
    return sources(root, CODE + ["tests"])


class Words(unittest.TestCase):
    def check(self, complaints):
        self.assertEqual(len(complaints), 0, "\n".join([f"{len(complaints)} complaints:", *complaints[:200]]))

    def test_comments_begin_as_sentences(self):
        self.check([f"{file}:{line}: {words}" for file in code_files(ROOT)
                    for line, words in fragments((ROOT / file).read_text())])

    def test_names_and_messages_use_terms_of_the_field(self):
        self.check([f"{file}:{line}: {word}" for file in sources(ROOT, CODE)
                    for line, word in home_made((ROOT / file).read_text(), file)])

    def test_sentences_of_guides_are_short(self):
        complaints = []
        for page in pages(ROOT):
            text = page.read_text()
            counts = lengths(text)
            complaints += [f"{page.name}: {n} words: {s[:80]}" for n, s in zip(counts, sentences(text)) if n > WORDS]
            if counts and sum(counts) / len(counts) > AVERAGE:
                complaints.append(f"{page.name}: {sum(counts) / len(counts):.1f} words on average")
        self.check(complaints)


class Planted(unittest.TestCase):
    """What the lint finds, in small texts."""

    def test_fragments(self):
        for first in ("Of the field.", "That of a ray.", "Nothing: lost.", "The same, of beams.", "What is given."):
            with self.subTest(first=first):
                self.assertEqual(list(fragments(f"int a;\n/// {first}\nint b;\n")), [(2, first)])
                self.assertEqual(len(list(fragments(f"  // {first}\n"))), 1)
        for text in ("/// Returns the field.\n", "/// Returns what is left\n/// of it.\n", "int a;  // Of it.\n",
                     "/// Offers.\n", "/// Andersen's method.\n"):
            with self.subTest(text=text):
                self.assertEqual(list(fragments(text)), [])

    def test_home_made_words(self):
        for text in ("int log_worth;", "class WaySearch {", "f(log_slopes_);", 'g("rests on few chances");',
                     "auto x = joined(a);"):
            with self.subTest(text=text):
                self.assertEqual(len(list(home_made(text, "core/a.cpp"))), 1)
        for text in ('#include "grin/house/way.h"', 'key("stage_way")', "// a worth", "int away;", 'g("a way");'):
            with self.subTest(text=text):
                self.assertEqual(list(home_made(text, "core/a.cpp")), [])
        self.assertEqual(list(home_made("double slope;", "bench/error/error_curve.h")), [])

    def test_sentences(self):
        page = ("# A heading of words\n\nOne two three. Four `a b c` six: see [a guide](x.md).\n- An item. Another one\n"
                "goes on.\n\n| a | table |\n\n```\ncode here. And there.\n```\n")
        self.assertEqual(lengths(page), [3, 6, 2, 4])

    def test_a_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "core").mkdir()
            (root / "core" / "a.h").write_text("/// As it is.\nint way;\n")
            [file] = sources(root, CODE)
            self.assertEqual(len(list(fragments((root / file).read_text()))), 1)
            self.assertEqual(len(list(home_made((root / file).read_text(), file))), 1)


def main(paths):
    for page in pages(ROOT):
        counts = lengths(page.read_text())
        if counts:
            print(f"{page.relative_to(ROOT)}: {len(counts)} sentences, average {sum(counts) / len(counts):.1f}, "
                  f"longest {max(counts)}, beyond {WORDS}: {sum(n > WORDS for n in counts)}")
    for file in code_files(ROOT):
        if any(str(file).startswith(path.rstrip("/")) for path in paths):
            text = (ROOT / file).read_text()
            for line, found in [*fragments(text), *home_made(text, file)]:
                print(f"{file}:{line}: {found}")


if __name__ == "__main__":
    main(sys.argv[1:]) if len(sys.argv) > 1 else unittest.main()
