"""Every command of the README and the guides has valid keys and values, by day every other one. By night the
blocks of each guide run one after the other, as for a reader."""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import unittest

from program import DATA, PROGRAM, WHOLE, ProgramTest, nightly

ROOT = DATA.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCK = re.compile(r"```(sh|python)\n(.*?)```|((?:^    [^\n]*\S[^\n]*\n)+)", re.DOTALL | re.MULTILINE)
WRITES = re.compile(r"^import .*(savetxt|np\.save\(|, \"wb?\"\))", re.DOTALL | re.MULTILINE)  # writes a file for later commands
RESOLVE = ("solve", "place", "covariance", "validate", "field", "image", "recover", "fit", "flux", "reflectance", "sweep", "trace",
           "render", "design", "optimise")
# Commands that are not run: they prepare the machine, need several machines, or hours.
APART = re.compile(r"^\s*(scripts/|cmake|ctest|cpack|mpirun|octave-cli|#SBATCH|build/|bench_|export )|--method mc|merge |bench |"
                   r"--frames frames.csv|SLURM_|--config reflection", re.MULTILINE)


def blocks(page):
    """Returns the blocks that a reader may run, in order: (language, text)."""
    for language, fenced, indented in BLOCK.findall(page.read_text()):
        if language:
            yield language, fenced
        elif indented.lstrip().startswith("flatspeckle "):
            yield "sh", indented


def to_be_run(block, left_out):
    """Returns a block's lines without those that are not run and those that read files these would have written."""
    for line in block.replace("\\\n", " ").splitlines():
        if APART.search(line) or left_out.intersection(line.split()):
            left_out.update(re.findall(r"--out (\S+)", line))
        else:
            yield line.strip()


def commands(block):
    """Returns the words after `flatspeckle`, of each of its lines."""
    for line in block.replace("\\\n", " ").splitlines():
        if line.strip().startswith("flatspeckle "):
            line = re.sub(r"\s#.*", "", re.sub(r'"?\$\{?\w+\}?"?', "0.5", line))
            yield shlex.split(line)[1:]


class Written(ProgramTest):
    def test_every_command_is_accepted(self):
        (self.folder / "data").symlink_to(DATA)
        for page in PAGES:
            written = [words for language, block in blocks(page) if language == "sh" for words in commands(block)]
            for words in written if WHOLE else written[::2]:
                if words[0] in RESOLVE and (WHOLE or "mean_field" not in words):  # computing the mean field takes seconds
                    with self.subTest(page=page.name, command=words):
                        self.check(words)

    def check(self, words):
        done = subprocess.run([PROGRAM, *words, "--print-config"], cwd=self.folder, capture_output=True,
                              text=True, timeout=60)
        missing = re.search("no such file|cannot read|not (a )?readable", done.stderr) and "data/" not in done.stderr
        if not missing:  # else a file made by another command or the reader
            self.assertEqual(done.returncode, 0, done.stderr)


@nightly
class Run(ProgramTest):
    def test_every_block_runs(self):
        for page in PAGES:
            with self.subTest(page=page.name):
                self.run_page(page)

    def run_page(self, page):
        folder = self.folder / page.stem
        folder.mkdir()
        for name in ("data", "plots"):
            (folder / name).symlink_to(ROOT / name)
        path = f"{pathlib.Path(PROGRAM).parent}:{os.environ['PATH']}"
        left_out = set()
        for language, block in blocks(page):
            if language == "python" and not WRITES.search(block):
                continue
            script = block if language == "python" else "\n".join(to_be_run(block, left_out))
            shell = [sys.executable, "-c"] if language == "python" else ["bash", "-euc"]
            done = subprocess.run([*shell, script], cwd=folder, capture_output=True, text=True,
                                  env={**os.environ, "PATH": path})
            self.assertEqual(done.returncode, 0, f"{script}\n{done.stderr}")
        shutil.rmtree(folder)


if __name__ == "__main__":
    unittest.main()
