#!/usr/bin/env python3
"""Writes the archive of a release for one target: binary, manual pages, completions, licences, README and changelog.

    tools/release_archive.py --binary target/release/benchdog --target x86_64-unknown-linux-gnu --out dist

The name is benchdog-VERSION-TARGET.tar.gz, or .zip for Windows; `[package.metadata.binstall]` in Cargo.toml relies on it. Equal
files give equal archives: entries are sorted, and their time is 1980-01-01, or SOURCE_DATE_EPOCH if that is later. The binary runs once for each page and
completion script, so this is for the machine's own target.
"""

import argparse
import gzip
import os
import shutil
import subprocess
import tarfile
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
COMPLETIONS = {"bash": "benchdog.bash", "zsh": "_benchdog", "fish": "benchdog.fish", "powershell": "_benchdog.ps1", "elvish": "benchdog.elv"}
PAGES = ["README.md", "CHANGELOG.md", "CITATION.cff", "LICENSE"]
# The earliest that a zip file can state is 1980.
EARLIEST_S = 315532800
EPOCH_S = max(int(os.environ.get("SOURCE_DATE_EPOCH", "0")), EARLIEST_S)


def fill(folder, binary):
    """Puts the files of a release into a folder."""
    shutil.copy(binary, folder / binary.name)
    for page in PAGES:
        shutil.copy(ROOT / page, folder / page)
    licences = folder / "licenses"
    licences.mkdir()
    for licence in sorted((ROOT / "assets").rglob("LICENSE-*")):
        shutil.copy(licence, licences / licence.name)
    subprocess.run([binary, "man", "--out", folder / "man"], check=True, stdout=subprocess.DEVNULL)
    completions = folder / "completions"
    completions.mkdir()
    for shell, name in COMPLETIONS.items():
        script = subprocess.run([binary, "completions", shell], check=True, stdout=subprocess.PIPE).stdout
        (completions / name).write_bytes(script)


def mode(path, binary):
    return 0o755 if path.is_dir() or path.name == binary.name else 0o644


def write_tar(archive, paths, above, binary):
    def plain(info):
        info.mtime, info.uid, info.gid, info.uname, info.gname = EPOCH_S, 0, 0, "", ""
        info.mode = mode(above / info.name, binary)
        return info

    with open(archive, "wb") as file, gzip.GzipFile("", "wb", 9, file, EPOCH_S) as packed:
        with tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as tar:
            for path in paths:
                tar.add(path, path.relative_to(above).as_posix(), recursive=False, filter=plain)


def write_zip(archive, paths, above, binary):
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for path in paths:
            if path.is_file():
                info = zipfile.ZipInfo(path.relative_to(above).as_posix(), time.gmtime(EPOCH_S)[:6])
                info.external_attr = (0o100000 | mode(path, binary)) << 16
                info.compress_type = zipfile.ZIP_DEFLATED
                packed.writestr(info, path.read_bytes())


def main():
    parser = argparse.ArgumentParser(description="Writes the archive of a release for one target.")
    parser.add_argument("--binary", type=Path, required=True)
    parser.add_argument("--target", required=True)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    binary = arguments.binary.resolve()
    printed = subprocess.run([binary, "--version"], check=True, stdout=subprocess.PIPE, text=True).stdout
    name = f"benchdog-{printed.split()[1]}-{arguments.target}"
    is_windows = "windows" in arguments.target
    arguments.out.mkdir(parents=True, exist_ok=True)
    archive = arguments.out / (name + (".zip" if is_windows else ".tar.gz"))
    with tempfile.TemporaryDirectory() as above:
        folder = Path(above, name)
        folder.mkdir()
        fill(folder, binary)
        if "linux" in arguments.target:
            subprocess.run(["strip", folder / binary.name], check=True)
        paths = [folder, *sorted(folder.rglob("*"))]
        (write_zip if is_windows else write_tar)(archive, paths, Path(above), binary)
    print(f"{archive}: {archive.stat().st_size / 1e6:.1f} MB, {len(paths)} entries")


main()
