"""A document of headings, paragraphs, tables and figures, as Markdown or as one HTML page. Text is
Markdown of the simplest kind: `code` and **bold**."""

import base64
import dataclasses
import html
import re


@dataclasses.dataclass
class Heading:
    level: int
    text: str


@dataclasses.dataclass
class Paragraph:
    text: str


@dataclasses.dataclass
class Table:
    header: list
    rows: list  # of lists of texts
    align: str  # l or r for each column
    caption: str = ""


@dataclasses.dataclass
class Figure:
    name: str
    caption: str
    alt: str


def markdown_cell(text):
    return text.replace("|", "\\|").replace("\n", " ")


def markdown_table(table):
    lines = ["| " + " | ".join(map(markdown_cell, table.header)) + " |",
             "|" + "|".join("---" if side == "l" else "---:" for side in table.align) + "|"]
    lines += ["| " + " | ".join(map(markdown_cell, row)) + " |" for row in table.rows]
    return ([f"**{table.caption}**", ""] if table.caption else []) + lines


def markdown_block(block):
    if isinstance(block, Heading):
        return ["#" * block.level + " " + block.text]
    if isinstance(block, Paragraph):
        return [block.text]
    if isinstance(block, Table):
        return markdown_table(block)
    return [f"![{block.alt}]({block.name}.png)", "", f"*{block.caption}*"]


def as_markdown(blocks):
    return "\n\n".join("\n".join(markdown_block(block)) for block in blocks) + "\n"


def inline(text):
    text = html.escape(text, quote=False)
    text = re.sub(r"`([^`]+)`", r"<code>\1</code>", text)
    return re.sub(r"\*\*([^*]+)\*\*", r"<strong>\1</strong>", text)


def html_table(table):
    side = {"l": "", "r": ' class="n"'}
    row = lambda tag, cells: "<tr>" + "".join(
        f"<{tag}{side[align]}>{inline(cell)}</{tag}>" for cell, align in zip(cells, table.align)
    ) + "</tr>"
    caption = f"<caption>{inline(table.caption)}</caption>" if table.caption else ""
    body = "\n".join(row("td", cells) for cells in table.rows)
    return (f'<div class="wide"><table>{caption}\n<thead>{row("th", table.header)}</thead>\n'
            f"<tbody>\n{body}\n</tbody></table></div>")


def html_block(block, pictures):
    if isinstance(block, Heading):
        return f"<h{block.level}>{inline(block.text)}</h{block.level}>"
    if isinstance(block, Paragraph):
        return f"<p>{inline(block.text)}</p>"
    if isinstance(block, Table):
        return html_table(block)
    picture = base64.b64encode(pictures[block.name]).decode()
    return (f'<figure><img alt="{html.escape(block.alt)}" '
            f'src="data:image/svg+xml;base64,{picture}">\n'
            f"<figcaption>{inline(block.caption)}</figcaption></figure>")


STYLE = """
:root { color-scheme: light dark; --paper: #fdfdfb; --ink: #1c1d1f; --soft: #5d6168;
  --rule: #dcdcd6; --shade: #f3f3ee; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #17181a; --ink: #e4e4e0; --soft: #9b9fa6; --rule: #36383c; --shade: #1f2124; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 3rem 1.25rem 5rem; max-width: 54rem; background: var(--paper);
  color: var(--ink); font: 1.04rem/1.6 Charter, "Bitstream Charter", "Iowan Old Style", Georgia, serif;
  text-rendering: optimizeLegibility; font-variant-numeric: lining-nums; }
h1, h2, h3, th, caption, figcaption, td, code { font-family: system-ui, "Segoe UI", Roboto,
  "Helvetica Neue", Arial, sans-serif; }
h1 { font-size: 1.9rem; line-height: 1.2; letter-spacing: -0.015em; margin: 0 0 1.2rem; }
h2 { font-size: 1.3rem; letter-spacing: -0.01em; margin: 3rem 0 0.6rem; padding-top: 1.2rem;
  border-top: 1px solid var(--rule); }
h3 { font-size: 1.02rem; margin: 2rem 0 0.4rem; }
p { margin: 0.7rem 0; max-width: 44rem; }
code { font-family: ui-monospace, "SF Mono", Menlo, Consolas, monospace; font-size: 0.88em; }
figure { margin: 1.6rem 0 2rem; }
figure img { display: block; width: 100%; height: auto; background: #fff; border-radius: 4px;
  border: 1px solid var(--rule); padding: 0.6rem; }
figcaption { color: var(--soft); font-size: 0.85rem; line-height: 1.45; margin-top: 0.5rem;
  max-width: 44rem; }
.wide { overflow-x: auto; margin: 1rem 0 1.6rem; }
table { border-collapse: collapse; font-size: 0.83rem; line-height: 1.35; min-width: 60%;
  font-variant-numeric: tabular-nums lining-nums; }
caption { text-align: left; font-weight: 600; padding-bottom: 0.35rem; }
th, td { text-align: left; vertical-align: top; padding: 0.28rem 0.9rem 0.28rem 0; }
th { color: var(--soft); font-weight: 500; border-bottom: 1px solid var(--ink); white-space: nowrap; }
td { border-bottom: 1px solid var(--rule); }
td:first-child { min-width: 14rem; }
.n { text-align: right; white-space: nowrap; }
@media print { body { max-width: none; padding: 0; font-size: 10pt; } figure, tr { break-inside: avoid; } }
"""


def as_html(blocks, pictures, title):
    """pictures: name -> bytes of an SVG."""
    body = "\n".join(html_block(block, pictures) for block in blocks)
    return ('<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<title>{html.escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
            f"{body}\n</body>\n</html>\n")
