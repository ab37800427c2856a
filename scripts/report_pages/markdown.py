"""Writes tables in Markdown, and converts a subset of Markdown to one HTML page: headings, paragraphs with `code` and
**bold**, tables with a caption in bold above, and pictures with a caption in italics below."""

import base64
import html
import pathlib
import re

STYLE = pathlib.Path(__file__).parent / "report.css"


def table(header, rows, align, caption=""):
    """Returns a Markdown table. rows: lists of texts; align: l or r for each column."""
    cell = lambda text: text.replace("|", "\\|").replace("\n", " ")
    lines = ["| " + " | ".join(map(cell, row)) + " |" for row in (header, *rows)]
    lines.insert(1, "|" + "|".join("---" if side == "l" else "---:" for side in align) + "|")
    return (f"**{caption}**\n\n" if caption else "") + "\n".join(lines)


def inline(text):
    text = html.escape(text, quote=False)
    text = re.sub(r"`([^`]+)`", r"<code>\1</code>", text)
    return re.sub(r"\*\*([^*]+)\*\*", r"<strong>\1</strong>", text)


def cells(line):
    return [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


def html_table(text, caption):
    header, sides, *rows = text.split("\n")
    classes = [' class="n"' if side.endswith(":") else "" for side in cells(sides)]
    row = lambda tag, line: "<tr>" + "".join(
        f"<{tag}{kind}>{inline(cell)}</{tag}>" for cell, kind in zip(cells(line), classes)) + "</tr>"
    head = f"<caption>{inline(caption)}</caption>" if caption else ""
    body = "\n".join(row("td", line) for line in rows)
    return (f'<div class="wide"><table>{head}\n<thead>{row("th", header)}</thead>\n'
            f"<tbody>\n{body}\n</tbody></table></div>")


def html_figure(text, caption, pictures):
    alt, name = re.fullmatch(r"!\[(.*)\]\((.*)\.png\)", text).groups()
    picture = base64.b64encode(pictures[name]).decode()
    return (f'<figure><img alt="{html.escape(alt)}" src="data:image/svg+xml;base64,{picture}">\n'
            f"<figcaption>{inline(caption)}</figcaption></figure>")


def html_blocks(text, pictures):
    blocks = ["", *text.strip().split("\n\n"), ""]
    for before, block, after in zip(blocks, blocks[1:], blocks[2:]):
        if block.startswith("#"):
            level, words = len(block.split(" ")[0]), block.lstrip("# ")
            yield f"<h{level}>{inline(words)}</h{level}>"
        elif block.startswith("|"):
            yield html_table(block, before.strip("*") if before.startswith("**") else "")
        elif block.startswith("!["):
            yield html_figure(block, after.strip("*"), pictures)
        elif not after.startswith("|") and not before.startswith("![") or not block.startswith("*"):
            yield f"<p>{inline(block)}</p>"


def as_html(text, pictures):
    """Returns the HTML page. pictures: name -> bytes of an SVG. The first line of the text is the title."""
    title = "flatspeckle: " + text.split("\n")[0].lstrip("# ")
    body = "\n".join(html_blocks(text, pictures))
    return ('<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<title>{html.escape(title)}</title>\n<style>\n{STYLE.read_text()}</style>\n</head>\n"
            f"<body>\n{body}\n</body>\n</html>\n")
