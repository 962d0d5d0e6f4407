#!/usr/bin/env python3
"""Builds the documentation site from docs/, and checks every link in it.

    tools/build_site.py OUT

`mdbook` and `benchdog` must be on the path; needs the Python package latex2mathml. OUT/src has the pages as mdbook reads them,
OUT/html the site. What differs from docs/:

- docs/verdicts.md is a page for each verdict and check;
- the reference of scenario keys is made from the JSON Schema, that of commands from their help texts;
- formulas are MathML, which browsers draw without scripts;
- links to files outside docs/ lead to the repository, and pictures from there are copied.

Ends with exit code 1 if a link in the site leads nowhere.
"""

import json
import re
import shutil
import subprocess
import sys
import tomllib
from html.parser import HTMLParser
from pathlib import Path, PurePosixPath
from urllib.parse import unquote, urlsplit

from latex2mathml.converter import convert

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
REPOSITORY = tomllib.loads((ROOT / "Cargo.toml").read_text())["package"]["repository"]
SCENARIO_SCHEMA = ROOT / "schemas/scenario.schema.json"
PICTURES = {".svg", ".png"}

# The keys of a scenario that its reader meets first; the others follow in the order of the alphabet.
FIRST_KEYS = ["format", "name", "object", "operation", "task", "tool", "human", "robot", "grip", "limits", "expect"]

# The chapters of verdicts.md whose sections become pages.
CHAPTERS_OF_PAGES = ["Verdicts", "Checks", "Self-checks"]


# ---- Markdown ----


def fenced_parts(text: str) -> list[tuple[bool, str]]:
    """A text in turns of prose and fenced blocks: whether a part is a block, and its text."""
    parts = re.split(r"^(```.*?^```[ ]*$)", text, flags=re.MULTILINE | re.DOTALL)
    return [(index % 2 == 1, part) for index, part in enumerate(parts)]


def mathml(formula: str, display: str) -> str:
    # Characters with a meaning in Markdown would end the element.
    escapes = {"*": "&#42;", "_": "&#95;", "|": "&#124;", "`": "&#96;", "\\": "&#92;", "[": "&#91;", "]": "&#93;", "\n": " "}
    html = convert(formula.strip(), display=display)
    return re.sub(r">([^<]*)<", lambda text: ">" + "".join(escapes.get(c, c) for c in text[1]) + "<", html)


def with_formulas(text: str) -> str:
    def inline(found: re.Match[str]) -> str:
        formula = found["quoted"] or found["plain"]
        return mathml(formula, "inline") if formula else found[0]

    def of(fenced: bool, part: str) -> str:
        if fenced:
            formula = re.fullmatch(r"```math\n(.*)```\s*", part, flags=re.DOTALL)
            return f"<div class=\"formula\">{mathml(formula[1], 'block')}</div>" if formula else part
        pattern = r"\$`(?P<quoted>[^`]+)`\$|(?P<code>`[^`]+`)|\$(?P<plain>[^$`]+)\$"
        return re.sub(pattern, inline, part)

    return "".join(of(*part) for part in fenced_parts(text))


def with_links(text: str, change) -> str:
    """A text whose relative links are changed by `change(target)`."""

    def changed(found: re.Match[str]) -> str:
        if found["code"] or re.match(r"[a-z]+:", found["target"]):
            return found[0]
        return f"]({change(found['target'])}{found['rest']}"

    pattern = r"(?P<code>`[^`]+`)|\]\((?P<target>[^)\s]+)(?P<rest>[^)]*\))"
    return "".join(part if fenced else re.sub(pattern, changed, part) for fenced, part in fenced_parts(text))


# ---- Pages ----


class Site:
    def __init__(self, out: Path) -> None:
        self.src = out / "src"
        self.sections = re.findall(r"^### (\S+)$", (DOCS / "verdicts.md").read_text(), flags=re.MULTILINE)

        self.scenario_schema = json.loads(benchdog("schema", "scenario"))

    def target(self, target: str, page: PurePosixPath) -> str:
        """A link of a page of docs/ as the site has it; `page` is the path of the page in the site."""
        path, _, anchor = target.partition("#")
        up = "../" * (len(page.parts) - 1)
        of_verdicts = path == "verdicts.md" or not path and page.parts[0] in ("verdicts", "verdicts.md")
        if of_verdicts and anchor in self.sections:
            return f"{up}verdicts/{anchor}.md"
        if not path:
            return f"../verdicts.md#{anchor}" if page.parts[0] == "verdicts" else target
        file = (DOCS / path).resolve()
        if file == SCENARIO_SCHEMA:
            return f"{up}reference/scenario.md" + (f"#{anchor}" if anchor else "")
        if file.is_relative_to(DOCS) and file.suffix in PICTURES | {".md"}:
            return up + target
        name = file.relative_to(ROOT).as_posix()
        if file.suffix in PICTURES:
            copy = self.src / "pictures" / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, copy)
            return f"{up}pictures/{name}"
        kind = "tree" if file.is_dir() else "blob"
        return f"{REPOSITORY}/{kind}/main/{name}" + (f"#{anchor}" if anchor else "")

    def write(self, page: str, text: str) -> None:
        path = PurePosixPath(page)
        file = self.src / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(with_formulas(with_links(text, lambda target: self.target(target, path))))

    def with_names_linked(self, text: str, own: str) -> str:
        """A section of verdicts.md with links from the names of other sections and from keys of scenarios to what explains them."""

        def linked(found: re.Match[str]) -> str:
            code = found[1]
            table = code.split(".")[0]
            if code in self.sections and code != own:
                return f"[`{code}`](#{code})"
            is_key = "." in code and table in self.scenario_schema["properties"]
            return f"[`{code}`](../schemas/scenario.schema.json#{table})" if is_key else found[0]

        return re.sub(r"`([^`]+)`", linked, text)

    def write_verdicts(self) -> dict[str, list[str]]:
        """docs/verdicts.md as a page of rules with the list of names, and a page for each name. The names of each chapter."""
        start, *chapters = re.split(r"^## (.+)\n", (DOCS / "verdicts.md").read_text(), flags=re.MULTILINE)
        names: dict[str, list[str]] = {}
        for title, body in zip(chapters[::2], chapters[1::2]):
            if title not in CHAPTERS_OF_PAGES:
                start += f"## {title}\n{body}"
                continue
            _, *sections = re.split(r"^### (\S+)\n", body, flags=re.MULTILINE)
            names[title] = sections[::2]
            start += f"## {title}\n\n"
            for name, text in zip(sections[::2], sections[1::2]):
                self.write(f"verdicts/{name}.md", f"# {name}\n{self.with_names_linked(text, name)}")
                summary = " ".join(text.strip().split("\n\n")[0].split())
                start += f"- [`{name}`](#{name}): {summary}\n"
            start += "\n"
        self.write("verdicts.md", start)
        return names


# ---- Reference ----


def benchdog(*arguments: str) -> str:
    return subprocess.run(["benchdog", *arguments], check=True, capture_output=True, text=True).stdout


def commands_page() -> str:
    """The help of every command, as it prints it."""

    def of(path: list[str]) -> str:
        text = benchdog("help", *path) if path else benchdog("--help")
        heading = f"{'#' * (len(path) + 1)} `{' '.join(['benchdog', *path])}`" if path else "# Commands"
        listed = re.search(r"^Commands:\n(.*?)\n\n", text, flags=re.MULTILINE | re.DOTALL)
        names = re.findall(r"^  (\S+)", listed[1], flags=re.MULTILINE) if listed else []
        below = [of([*path, name]) for name in names if name != "help"]
        return "\n".join([heading, "", "```text", text.rstrip(), "```", "", *below])

    return of([])


class ScenarioKeys:
    """The reference of a scenario's keys, of its JSON Schema."""

    def __init__(self, schema: dict) -> None:
        self.schema = schema
        self.definitions = schema["$defs"]
        self.to_write: list[str] = []

    def resolved(self, schema: dict) -> tuple[str | None, dict]:
        """The name of a definition, if it is one, and the definition; of a choice between a type and null the type."""
        if "$ref" in schema:
            name = schema["$ref"].rsplit("/", 1)[1]
            return name, self.definitions[name]
        choices = [choice for choice in schema.get("anyOf", []) if choice.get("type") != "null"]
        return self.resolved(choices[0]) if len(choices) == 1 else (None, schema)

    def type_of(self, schema: dict) -> str:
        name, found = self.resolved(schema)
        choices = found.get("oneOf") or found.get("anyOf") or []
        if choices and all("const" in choice for choice in choices):
            return "one of " + ", ".join(f"`{json.dumps(choice['const'])}`" for choice in choices)
        if "enum" in found:
            return "one of " + ", ".join(f"`{json.dumps(value)}`" for value in found["enum"])
        if "properties" in found or choices:
            if name is None:
                return " or ".join(self.type_of(choice) for choice in choices if choice.get("type") != "null")
            if name not in self.to_write:
                self.to_write.append(name)
            return f"[{self.title(name)}](#{self.title(name).lower().replace(' ', '-')})"
        kinds = found.get("type", "any")
        kind = kinds if isinstance(kinds, str) else next(kind for kind in kinds if kind != "null")
        if kind == "array" and "items" in found:
            least, most = found.get("minItems"), found.get("maxItems")
            count = f"{least} x " if least is not None and least == most else "list of "
            return count + self.type_of(found["items"])
        return "whole number" if kind == "integer" else kind

    @staticmethod
    def title(name: str) -> str:
        return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", re.sub(r"(Section|Settings|Record)$", "", name)).capitalize()

    def meaning(self, schema: dict) -> str:
        _, found = self.resolved(schema)
        text = schema.get("description") or found.get("description", "")
        values = [choice for choice in found.get("oneOf", []) if "const" in choice and "description" in choice]
        for value in values:
            text += f"<br>`{json.dumps(value['const'])}`: {value['description']}"
        return " ".join(text.split()).replace("|", "\\|")

    def table(self, definition: dict, default: dict | None) -> str:
        rows = ["| key | type | default | meaning |", "|---|---|---|---|"]
        required = definition.get("required", [])
        for key, schema in definition["properties"].items():
            value = (default or {}).get(key, schema.get("default"))
            shown = "required" if key in required else "" if value is None else f"`{json.dumps(value)}`"
            rows.append(f"| `{key}` | {self.type_of(schema)} | {shown} | {self.meaning(schema)} |")
        return "\n".join(rows)

    def page(self) -> str:
        parts = [
            "# Scenario keys\n\nMade from the JSON Schema that `benchdog schema scenario` prints. A scenario is TOML; a key that is not "
            "here is an error. Where no default is stated, the meaning has it.\n",
            "## Top level\n\n`format`, `name` and one of `operation` and `task` are required.\n\n| key | type | meaning |\n|---|---|---|",
        ]
        tables = []
        properties = self.schema["properties"]
        keys = [*FIRST_KEYS, *(key for key in properties if key not in FIRST_KEYS)]
        for key, schema in ((key, properties[key]) for key in keys):
            _, found = self.resolved(schema)
            if "properties" not in found:
                parts.append(f"| `{key}` | {self.type_of(schema)} | {self.meaning(schema)} |")
                continue
            parts.append(f"| [`[{key}]`](#{key}) | table | {self.meaning({**found, **schema})} |")
            about = found.get("description", "")
            tables.append(f"\n## `[{key}]`\n\n{about}\n\n{self.table(found, schema.get('default'))}")
        written = 0
        others = []
        while written < len(self.to_write):
            name = self.to_write[written]
            written += 1
            found = self.definitions[name]
            head = f"\n## {self.title(name)}\n\n{found.get('description', '')}\n"
            if "properties" in found:
                others.append(f"{head}\n{self.table(found, None)}")
            else:
                choices = found.get("oneOf") or found.get("anyOf")
                described = [f"- {self.type_of(choice)}: {self.meaning(choice)}" for choice in choices]
                others.append(head + "\n" + "\n".join(described))
        return "\n".join([*parts, *tables, *others]) + "\n"


# ---- Links of the site ----


class Links(HTMLParser):
    """The links and the anchors of a page."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(html)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for name, value in attributes:
            if name in ("href", "src") and value:
                self.links.append(value)
            elif name == "id" and value:
                self.anchors.add(value)


def broken_links(html: Path) -> tuple[int, list[str]]:
    """How many links to files of the site there are, and those that lead nowhere."""
    pages = {file: Links(file.read_text()) for file in sorted(html.rglob("*.html"))}
    count, broken = 0, []
    for file, page in pages.items():
        # These are written for the root of the site.
        if file.name in ("404.html", "toc.html"):
            continue
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            count += 1
            found = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            found = found / "index.html" if found.is_dir() else found
            if not found.is_file():
                broken.append(f"{file.relative_to(html)}: {link}: there is no such file")
            elif parts.fragment and found in pages and unquote(parts.fragment) not in pages[found].anchors:
                broken.append(f"{file.relative_to(html)}: {link}: there is no such heading")
    return count, broken


# ---- Everything ----


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    out = Path(sys.argv[1]).resolve()
    shutil.rmtree(out, ignore_errors=True)
    site = Site(out)
    site.src.mkdir(parents=True)
    for file in sorted(DOCS.rglob("*")):
        name = file.relative_to(DOCS).as_posix()
        if file.suffix in PICTURES or file.name in ("book.toml", "site.css"):
            copy = (out if file.suffix in (".toml", ".css") else site.src) / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, copy)
        elif file.suffix == ".md" and name not in ("verdicts.md", "SUMMARY.md"):
            site.write(name, file.read_text())
    names = site.write_verdicts()
    site.write("reference/scenario.md", ScenarioKeys(site.scenario_schema).page())
    site.write("reference/commands.md", commands_page())
    # The table of contents has an entry without a page for what is made here.
    summary = (DOCS / "SUMMARY.md").read_text()
    for title, page in [("Scenario keys", "scenario"), ("Commands", "commands")]:
        summary = summary.replace(f"[{title}]()", f"[{title}](reference/{page}.md)")
    for title, of_chapter in names.items():
        lines = [f"    - [{name}](verdicts/{name}.md)" for name in of_chapter]
        summary = summary.replace(f"  - [{title}]()", "\n".join([f"  - [{title}]()", *lines]))
    (site.src / "SUMMARY.md").write_text(summary)
    subprocess.run(["mdbook", "build", str(out)], check=True)
    count, broken = broken_links(out / "html")
    print(f"{count} links within the site, {len(broken)} broken")
    if broken:
        sys.exit("\n".join(broken))


if __name__ == "__main__":
    main()
