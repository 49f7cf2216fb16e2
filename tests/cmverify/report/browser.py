"""Look at a page in a headless browser, where there is one: what sticks out, what is wrong."""

from __future__ import annotations

import html
import json
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

#: Width in px of a sheet of A4 between the margins of the print style.
SHEET = 703

_PROBE = """<script>
addEventListener("load", () => {
  const root = document.documentElement, wide = [];
  document.querySelectorAll("details").forEach(d => d.open = %s);
  for (const box of document.querySelectorAll(".scroll"))
    for (const inner of box.children)
      if (inner.offsetWidth > box.clientWidth + 1)
        wide.push([box.getAttribute("aria-label"), inner.offsetWidth, box.clientWidth]);
  const reach = [...document.querySelectorAll(".scroll")].filter(b => b.tabIndex !== 0).length;
  const seen = {contentVisibilityAuto: true};
  const checks = [...document.querySelectorAll(".checks table")];
  const folded = checks.filter(table => !table.checkVisibility(seen)).length;
  const blind = [...document.images].filter(i => !i.complete || !i.naturalWidth || !i.alt).length;
  const out = document.createElement("pre");
  out.id = "probe";
  out.textContent = JSON.stringify({page: root.scrollWidth, window: root.clientWidth, wide,
    unreachable: reach, blind, folded, height: root.scrollHeight});
  document.body.append(out);
});
</script>"""


def find() -> str | None:
    """A Chromium on this machine, or None."""
    names = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
    return next((found for name in names if (found := shutil.which(name))), None)


def look(page: Path, width: int, *, printed: bool = False, opened: bool = False) -> dict[str, Any]:
    """What the page looks like at a width: its own width, tables that stick out, the console.

    Parameters
    ----------
    printed : bool
        Whether the rules for print hold.
    opened : bool
        Whether what is folded is unfolded first.
    """
    text = page.read_text(encoding="utf-8")
    if printed:
        text = text.replace("@media print", "@media all")
    text = text.replace("</body>", _PROBE % ("true" if opened else "d.open") + "</body>")
    chromium = find()
    assert chromium is not None
    handle, name = tempfile.mkstemp(suffix=".html", dir=page.parent)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            stream.write(text)
        with tempfile.TemporaryDirectory() as profile:
            done = subprocess.run(
                [chromium, "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
                 f"--user-data-dir={profile}", f"--window-size={width},900",
                 "--enable-logging=stderr", "--v=0", "--timeout=20000", "--dump-dom",
                 Path(name).as_uri()],
                capture_output=True, timeout=240, check=True,
            )  # fmt: skip
    finally:
        os.unlink(name)
    dom = done.stdout.decode("utf-8", "replace")
    found = re.search(r'<pre id="probe">(.*?)</pre>', dom, re.S)
    assert found, done.stderr.decode("utf-8", "replace")[-2000:]
    seen: dict[str, Any] = json.loads(html.unescape(found[1]))
    said = done.stderr.decode("utf-8", "replace")
    seen["console"] = [line for line in said.splitlines() if ":CONSOLE" in line]
    return seen


def dead_links(page: Path) -> list[str]:
    """Links of a page that lead nowhere, and whatever it would fetch from elsewhere."""
    text = re.sub(r'"data:[^"]*"', '""', page.read_text(encoding="utf-8"))
    names = set(re.findall(r'\bid="([^"]+)"', text))
    bad = []
    for target in re.findall(r'(?:href|src)="([^"]*)"', text):
        target = html.unescape(target)
        if target.startswith("#"):
            known = target[1:] in names
        else:
            known = not target or (page.parent / target.split("#")[0]).is_file()
        if not known:
            bad.append(target)
    return bad
