"""The site is built without a warning and without a dead link, and has every guide, key and dataset."""

import html
import importlib.util
import pathlib
import re
import shutil
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import site_pages


class SiteTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.site = pathlib.Path(cls.folder.name) / "site"
        site_pages.main(cls.site)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_guides(self):
        chapters = {page for pages in site_pages.CHAPTERS.values() for page in pages}
        for guide in (ROOT / "docs").glob("*.md"):
            self.assertIn(guide.stem, chapters)
            self.assertTrue((self.site / f"{guide.stem}.html").exists())

    def test_keys_and_datasets(self):
        for page in ("keys", "format"):
            shown = (self.site / f"{page}.html").read_text()
            for name in re.findall(r"^\| `([\w/]+)` \|", (ROOT / "docs" / f"{page}.md").read_text(), re.MULTILINE):
                self.assertIn(f">{name}</span>", shown)

    def test_what_looks_like_html_is_shown(self):
        for page, text in (("conventions", "g = <cos theta>"), ("format", "<I I'> / (<I> <I'>) - 1")):
            shown = html.unescape(re.sub(r"<[^>]*>", "", (self.site / f"{page}.html").read_text()))
            self.assertIn(text, shown.replace("\u2019", "'"))

    def test_links_have_titles(self):
        for page in self.site.glob("*.html"):
            self.assertNotRegex(page.read_text(), r">(docs/)?\w+\.md</a>")

    def test_libraries(self):
        self.assertTrue((self.site / "api" / "annotated.html").exists())

    def test_dead_links_are_found(self):
        page = self.site / "tour.html"
        text = page.read_text()
        self.addCleanup(page.write_text, text)
        page.write_text(text.replace("</article>", '<a href="nowhere.html">x</a> <a href="keys.html#nowhere">y</a></article>'))
        found = {link for _, link in site_pages.dead_links(self.site)}
        self.assertEqual(found, {"nowhere.html", "keys.html#nowhere"})


if __name__ == "__main__":
    if not shutil.which("sphinx-build") or not shutil.which("doxygen") or not importlib.util.find_spec("myst_parser"):
        sys.exit(77)
    unittest.main()
