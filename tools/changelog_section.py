#!/usr/bin/env python3
"""Prints the section of CHANGELOG.md for a release: tools/changelog_section.py v0.2.0

Ends with an error unless the tag, the version in Cargo.toml and a section with a date and text belong together.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def version():
    """The version in Cargo.toml: that of the workspace."""
    manifest = (ROOT / "Cargo.toml").read_text(encoding="utf-8")
    found = re.search(r'^\[workspace\.package\]\nversion = "([^"]+)"', manifest, re.MULTILINE)
    return found[1] if found else sys.exit("Cargo.toml: found no version under [workspace.package]")


def section(of):
    """The text of the section of a version, without its heading and the links at the end of the file."""
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    heading = re.search(rf"^## \[{re.escape(of)}\](.*)\n", changelog, re.MULTILINE)
    if not heading:
        sys.exit(f"CHANGELOG.md: found no section [{of}]")
    if not re.fullmatch(r" - \d{4}-\d{2}-\d{2}", heading[1]):
        sys.exit(f"CHANGELOG.md: found \"{heading[0].strip()}\", expected \"## [{of}] - YEAR-MONTH-DAY\"")
    text = re.split(r"^(?:## |\[[^\]]+\]: )", changelog[heading.end():], maxsplit=1, flags=re.MULTILINE)[0].strip()
    return text or sys.exit(f"CHANGELOG.md: the section [{of}] is empty")


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: tools/changelog_section.py TAG")
    tag = sys.argv[1]
    if tag != f"v{version()}":
        sys.exit(f"found the tag {tag}, expected v{version()}, the version in Cargo.toml")
    sys.stdout.reconfigure(encoding="utf-8")
    print(section(version()))


main()
