#!/usr/bin/env bash
# Installs a wheel as a stranger would: a new virtual environment, an empty home, no Rust on the path, no repository. Then the files
# of `benchdog init` are run and tested. Prints the size of the wheel and the seconds of each step.
# tools/check_wheel.sh target/wheels [EXAMPLE]
set -euo pipefail

wheels=("$(cd "$1" && pwd)"/*.whl)
example=${2:-drill}
[ ${#wheels[@]} -eq 1 ] && [ -f "${wheels[0]}" ] || { echo "$1: expected one wheel" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

python=python3
command -v "$python" >/dev/null || python=python
"$python" -m venv environment
bin=$folder/environment/bin
[ -d "$bin" ] || bin=$folder/environment/Scripts
mkdir home
# All that runs below has this environment: the shell's own tools, and no folder of the user.
clean=(env HOME="$folder/home" PATH="$bin:/usr/bin:/bin" BENCHDOG_CACHE="$folder/home/maps")
if "${clean[@]}" sh -c 'command -v cargo || command -v rustc'; then
    echo "Rust is on the clean path: the check would prove nothing" >&2
    exit 1
fi

timed() {
    local name=$1 begin
    shift
    begin=$(date +%s)
    "$@"
    echo "$name: $(($(date +%s) - begin)) s"
}

echo "wheel: $(wc -c < "${wheels[0]}") bytes"
timed "pip install" "${clean[@]}" "$bin/python" -m pip install --quiet --disable-pip-version-check "${wheels[0]}" pytest
"${clean[@]}" "$bin/benchdog" init boards --example "$example"
cd boards
if [ "$example" = task ]; then
    timed "benchdog task" "${clean[@]}" "$bin/benchdog" task tasks/edge.toml
else
    timed "benchdog run" "${clean[@]}" "$bin/benchdog" run scenarios
fi
timed "pytest" "${clean[@]}" "$bin/python" -m pytest -q -p no:cacheprovider
