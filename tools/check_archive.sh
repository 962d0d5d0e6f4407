#!/usr/bin/env bash
# Unpacks an archive of a release into an empty folder and uses its binary as a stranger would: init, run.
# tools/check_archive.sh dist/benchdog-0.2.0-x86_64-unknown-linux-gnu.tar.gz
set -euo pipefail

archive=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
case $archive in
    *.zip) unzip -q "$archive" ;;
    *) tar -xzf "$archive" ;;
esac
name=$(basename "$archive")
name=${name%.tar.gz}
name=${name%.zip}
for part in README.md LICENSE licenses/LICENSE-baxter_common man/benchdog.1 man/benchdog-run.1 completions/_benchdog; do
    [ -s "$name/$part" ] || { echo "$archive: found no $part" >&2; exit 1; }
done
mkdir home
export HOME=$folder/home BENCHDOG_CACHE=$folder/home/maps
"$folder/$name/benchdog" init boards
cd boards
"$folder/$name/benchdog" run scenarios
