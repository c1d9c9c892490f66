"""Pages for browsers from the Markdown files in a folder and below: NAME.html beside each NAME.md, links between them turned.

usage: PYTHONPATH=build/tools/ford python3 tools/docs_pages.py FOLDER [PAGE.html...]      PAGE: there already, only its links are turned
"""
import pathlib
import re
import sys

import markdown

frame = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{title}</title>
<style>
body {{ font: 16px/1.5 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; }}
pre, code {{ background: #f4f4f4; font-size: 14px; }} pre {{ padding: .6em; overflow-x: auto; }} img {{ max-width: 100%; }}
table {{ border-collapse: collapse; }} th, td {{ border: 1px solid #ccc; padding: .2em .5em; text-align: left; }}
</style></head><body>
<p><a href="{up}index.html">poinsot</a></p>
{body}
</body></html>
"""


def turned(text, folder):
    """Links to Markdown files that are here lead to their pages."""
    def turn(match):
        path, place = match.group(1), match.group(2) or ""
        return f'href="{path[:-3]}.html{place}"' if (folder / path).is_file() else match.group(0)
    return re.sub(r'href="([^":#]*\.md)(#[^"]*)?"', turn, text)


top = pathlib.Path(sys.argv[1])
for source in sorted(top.rglob("*.md")):
    text = source.read_text(encoding="utf-8")
    title = re.search(r"^# *(.*)", text, re.M)
    body = markdown.markdown(text, extensions=["tables", "fenced_code", "toc", "sane_lists"])
    depth = len(source.relative_to(top).parts) - 1
    source.with_suffix(".html").write_text(
        frame.format(title=title.group(1) if title else source.stem, up="../" * depth, body=turned(body, source.parent)),
        encoding="utf-8")
for page in map(pathlib.Path, sys.argv[2:]):
    page.write_text(turned(page.read_text(encoding="utf-8"), page.parent), encoding="utf-8")
