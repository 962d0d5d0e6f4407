#!/usr/bin/env python3
"""Runs what a page tells a reader to type: every line of its `sh` blocks, in order, beginning in a folder; `cd FOLDER` changes it.

    tools/run_walk.py PAGE FOLDER

What the page's commands need must be on the path. Ends at the first command with another exit code than 0, or than N of a line that
ends with `# exit code N`.
"""

import re
import subprocess
import sys
from pathlib import Path


def commands(page: str) -> list[str]:
    blocks = re.findall(r"^```sh\n(.*?)^```", page, flags=re.MULTILINE | re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line.strip() and not line.startswith("#")]


def main() -> None:
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    page, folder = Path(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    lines = commands(page.read_text())
    if not lines:
        sys.exit(f"{page}: found no sh block, expected commands")
    for line in lines:
        print(f"$ {line}", flush=True)
        stated = re.search(r"# exit code (\d+)$", line)
        expected = int(stated[1]) if stated else 0
        if line.startswith("cd "):
            folder = folder / line.removeprefix("cd ").strip()
            continue
        found = subprocess.run(line, shell=True, cwd=folder).returncode
        if found != expected:
            sys.exit(f"{page}: found exit code {found}, expected {expected}: {line}")


if __name__ == "__main__":
    main()
