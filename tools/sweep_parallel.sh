#!/bin/sh
# A sweep over several hosts by GNU parallel, which starts a part wherever a host is free.
#
#     tools/sweep_parallel.sh PLAN PARTS DIR HOSTS [OPTION OF benchdog sweep ...]
#
# PLAN     a plan file (plan once: benchdog plan SCENARIO -o plan.json)
# PARTS    the number of parts, some times that of the hosts
# DIR      folder for the parts (DIR/part-M) and the sweep (DIR/sweep)
# HOSTS    as GNU parallel's --sshlogin: 2/user@first,4/user@second (parts at a time on each); : is this machine
#
# Needs GNU parallel and rsync. All hosts must have the same benchdog, by BENCHDOG or in PATH. Plan and results travel over ssh, so no shared folder is needed.
# Parts that failed, or were killed, are done again with the same command; finished ones are not.
set -eu
if [ $# -lt 4 ]; then
    sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
plan=$(realpath "$1") parts=$2 folder=$(realpath -m "$3") hosts=$4
shift 4
benchdog=${BENCHDOG:-benchdog}
mkdir -p "$folder"
cp "$plan" "$folder/to-sweep.json"
cd "$folder"
# --basefile copies the plan to each host, --return the folder of a part back. They are in WORKDIR, below the home of each host.
# The log says which parts are done.
seq 1 "$parts" | parallel --sshlogin "$hosts" --workdir "${WORKDIR:-sweep-of-benchdog}" --basefile to-sweep.json --return part-{} --cleanup \
    --joblog parts.log --resume-failed --halt soon,fail=50% \
    "$benchdog" sweep to-sweep.json --shard "{}/$parts" --jobs 1 --out part-{} "$@" ">/dev/null"
# shellcheck disable=SC2046
"$benchdog" merge $(seq -f 'part-%g' -s ' ' 1 "$parts") --out sweep
