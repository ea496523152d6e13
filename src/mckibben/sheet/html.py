"""The datasheet as one HTML file that needs nothing beside it."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from mckibben.sheet.words import Page

__all__ = ["html"]

STYLE = """
body { font: 14px/1.45 system-ui, "DejaVu Sans", sans-serif; color: #111; background: #fff; max-width: 860px;
  margin: 1.5em auto; padding: 0 1em; overflow-wrap: break-word; }
h1 { font-size: 1.7em; margin: 0; } h2 { font-size: 1.1em; color: #0072b2; margin: 1.6em 0 .4em; }
p.about, footer { color: #555; } footer { font-size: .85em; margin-top: 2em; }
svg { width: 100%; height: auto; } table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: .25em .8em .25em 0; border-bottom: 1px solid #ddd; }
thead th { border-bottom: 1px solid #444; } code { font-size: .9em; } .mark { color: #b84a00; font-weight: bold; }
@media print { body { font-size: 10px; margin: 0; } h2, svg { break-after: avoid; } tr { break-inside: avoid; } }
"""
POLICY = "default-src 'none'; style-src 'unsafe-inline'"
"""What a browser may load for the page: nothing."""


def html(page: Page) -> bytes:
    """The whole page; every text is escaped, pictures are part of it."""
    key = _table((), ((_th(what), _td(value)) for what, value in page.key))
    levels = _table(page.heads, (tuple(map(_td, row)) for row in page.levels))
    parameters = _table(
        ("Field", "Value", "Meaning", ""),
        (
            (f"<td><code>{escape(name)}</code></td>", _td(value), _td(meaning), f'<td class="mark">{escape(mark)}</td>')
            for name, value, meaning, mark in page.parameters
        ),
    )
    reasons = "".join(f"<p>{escape(reason)}</p>\n" for reason in page.reasons)
    limits = "".join(f"<li>{escape(said)}</li>\n" for said in page.limits)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<title>{escape(page.title)}</title>
<style>{STYLE}</style>
</head>
<body>
<h1>{escape(page.title)}</h1>
<p class="about">{escape(page.subtitle)}</p>
{page.drawing}
<h2>Key numbers</h2>
{key}
<h2>Force against contraction</h2>
{page.curves}
<h2>At each pressure</h2>
{levels}
{reasons}<h2>Parameters</h2>
{parameters}
<h2>Assumptions and limits</h2>
<ul>
{limits}</ul>
<footer>{escape(page.made)}</footer>
</body>
</html>
""".encode()


def _td(text: str) -> str:
    return f"<td>{escape(text)}</td>"


def _th(text: str) -> str:
    return f'<th scope="row">{escape(text)}</th>'


def _table(heads: Iterable[str], rows: Iterable[tuple[str, ...]]) -> str:
    head = "".join(f'<th scope="col">{escape(text)}</th>' for text in heads)
    body = "\n".join(f"<tr>{''.join(row)}</tr>" for row in rows)
    return f"<table>\n{f'<thead><tr>{head}</tr></thead>' if head else ''}<tbody>\n{body}\n</tbody></table>"
