#!/usr/bin/env python3
"""Builds the site of the guides: site_pages.py FOLDER. Uses Sphinx (MyST, furo) for pages and Doxygen for the
libraries, without network. Exits with status 1 after a warning or a broken link. scripts/site.sh installs the
required packages."""

import ast
import html.parser
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"

# Pages of the sidebar, in this order; a test checks that every guide is included.
CHAPTERS = {
    "First": ["start_speckle", "start_graphics", "start_tissue", "start_sound", "tour", "questions", "tutorials", "gallery"],
    "Speckle": ["monte_carlo", "exact_solver", "media", "dynamics", "tissue", "sweeps", "experiments", "imaging", "pictures", "fit"],
    "Rays and light": ["rays", "design", "render"],
    "Reference": ["commands", "scenes", "keys", "format", "conventions", "python", "library"],
    "About": ["report/report", "development", "contributing", "changelog", "theory"],
}
PICTURE = re.compile(r"!\[([^\]]*)\]\(([^)]+\.(?:png|jpg))\)")
LINK = re.compile(r"(\]\()(?:docs/)?([^):]+\))")
NAMED_BY_FILE = re.compile(r"\[(?:docs/)?[\w/]+\.md\]\(([\w/]+)\.md\)")


def flattened(text):
    """Adapts links of a page at the root of the checkout: the site has the guides at its root."""
    text = LINK.sub(r"\1\2", text)
    return text.replace("(CONTRIBUTING.md", "(contributing.md").replace("(CHANGELOG.md", "(changelog.md")


def title_of(page):
    return next(line[2:] for line in page.read_text().splitlines() if line.startswith("# "))


def name_links(source):
    """Replaces link texts that are file names by the titles of the pages."""
    for page in source.rglob("*.md"):
        text = NAMED_BY_FILE.sub(lambda link: f"[{title_of(source / f'{link[1]}.md')}]({link[1]}.md)", page.read_text())
        page.write_text(text)


def sidebar():
    parts = []
    for chapter, pages in CHAPTERS.items():
        parts.append(":::{toctree}\n:hidden:\n:maxdepth: 1\n:caption: " + chapter + "\n\n"
                     + "\n".join(pages) + "\n:::\n")
    return "\n".join(parts)


def tutorial_page(script):
    """Returns the page of a tutorial: docstring, picture and code of its script."""
    text = script.read_text()
    description = ast.get_docstring(ast.parse(text)).strip()
    first, _, rest = description.partition("\n\n")
    code = text.split('"""', 2)[2].strip()
    return (f"# {first.rstrip('.')}\n\n{rest}\n\n![{first}]({script.stem}.png)\n\n"
            f"```python\n{code}\n```\n")


def gallery(source):
    """Returns a page with every picture of the guides as a thumbnail linked to its explanation."""
    tiles, shown = [], set()
    for page in [page for pages in CHAPTERS.values() for page in pages if page != "gallery"]:
        folder = (source / page).parent.relative_to(source)
        for caption, picture in PICTURE.findall((source / f"{page}.md").read_text()):
            if (path := folder / picture) not in shown:
                tiles.append(f"[![{caption}]({path}) {caption}]({page}.md)")
            shown.add(path)
    return "# Gallery\n\n<div class=\"gallery\">\n\n" + "\n\n".join(tiles) + "\n\n</div>\n"


def write_source(source):
    shutil.copytree(DOCS, source, ignore=shutil.ignore_patterns("site", "*.json"))
    shutil.copytree(DOCS / "site" / "static", source / "static")
    shutil.copy(DOCS / "site" / "conf.py", source)
    shutil.copy(ROOT / "LICENSE", source)
    (source / "index.md").write_text(flattened((ROOT / "README.md").read_text()) + "\n" + sidebar())
    for name in ("CONTRIBUTING", "CHANGELOG"):
        (source / f"{name.lower()}.md").write_text(flattened((ROOT / f"{name}.md").read_text()))
    scripts = sorted((source / "tutorials").glob("*.py"))
    for script in scripts:
        script.with_suffix(".md").write_text(tutorial_page(script))
    tutorials = source / "tutorials.md"
    pages = "\n".join(f"tutorials/{script.stem}" for script in scripts)
    tutorials.write_text(tutorials.read_text().replace(".py)", ".md)")
                         + f"\n:::{{toctree}}\n:hidden:\n\n{pages}\n:::\n")
    library = source / "library.md"
    library.write_text(library.read_text()
                       + '\n<p><a href="api/annotated.html">Classes and functions of the libraries</a></p>\n')
    (source / "gallery.md").write_text(gallery(source))
    name_links(source)


def run(*command, **more):
    if subprocess.run(command, **more).returncode != 0:
        sys.exit(f"site: {command[0]} reported warnings or errors: see above")


class Links(html.parser.HTMLParser):
    """Collects the links of a page and the anchors in it."""

    def __init__(self, text):
        super().__init__()
        self.targets, self.places = set(), {""}
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("href", "src") and value and tag != "link":
                self.targets.add(value)
            elif name in ("id", "name") and value:
                self.places.add(value)


def dead_links(site):
    """Returns (page, link) of the broken links within the site; Doxygen checks its own pages."""
    pages = {path: Links(path.read_text()) for path in site.rglob("*.html")
             if path.relative_to(site).parts[0] != "api"}
    dead = []
    for path, links in pages.items():
        for link in links.targets:
            url = urllib.parse.urlparse(link)
            if url.scheme:
                continue
            target = path if not url.path else (path.parent / urllib.parse.unquote(url.path)).resolve()
            place = urllib.parse.unquote(url.fragment)
            if not target.exists() or (target in pages and place not in pages[target].places):
                dead.append((path.relative_to(site), link))
    return dead


def main(folder):
    site = pathlib.Path(folder).resolve()
    shutil.rmtree(site, ignore_errors=True)
    with tempfile.TemporaryDirectory() as scratch:
        source = pathlib.Path(scratch) / "source"
        write_source(source)
        run("sphinx-build", "-W", "--keep-going", "-q", "-b", "html", source, site)
    settings = (DOCS / "site" / "Doxyfile").read_text() + f"\nOUTPUT_DIRECTORY = {site}\nHTML_OUTPUT = api\n"
    run("doxygen", "-", cwd=ROOT, input=settings.encode())
    shutil.rmtree(site / ".doctrees", ignore_errors=True)
    dead = dead_links(site)
    for page, link in dead:
        print(f"{page}: broken link {link}")
    if dead:
        sys.exit(1)
    print(f"{site}/index.html")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
