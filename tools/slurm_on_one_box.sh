#!/bin/sh
# Slurm with two nodes on this machine, and on it a sweep of 6 parts as a job array: a task is killed while it runs, submitted again,
# and the merged sweep is compared byte for byte with the sweep in one go.
#
#     tools/slurm_on_one_box.sh BENCHDOG PLAN DIR [RUNS]
#
# Needs Debian's packages slurmctld, slurmd, slurm-client and slurm-wlm-basic-plugins, and root. Starts two daemons of a node and a
# controller of their own, with files in DIR/slurm, and stops them at the end. Nothing of this is for a real cluster: there is no
# authentication.
set -eu
if [ $# -lt 3 ]; then
    sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
here=$(dirname "$(realpath "$0")")
BENCHDOG=$(realpath "$1") plan=$(realpath "$2") folder=$(realpath -m "$3") runs=${4:-240}
export BENCHDOG
slurm=$folder/slurm
rm -rf "$folder"
mkdir -p "$slurm/state" "$slurm/spool/n1" "$slurm/spool/n2" "$slurm/log"
host=$(hostname -s)
cat > "$slurm/slurm.conf" <<EOF
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool/%n
SlurmctldPidFile=$slurm/controller.pid
SlurmdPidFile=$slurm/%n.pid
SlurmctldLogFile=$slurm/log/controller.log
SlurmdLogFile=$slurm/log/%n.log
SlurmctldPort=26817
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SwitchType=switch/none
ReturnToService=2
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=26821 CPUs=1 State=UNKNOWN
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=26822 CPUs=1 State=UNKNOWN
PartitionName=p Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
EOF
export SLURM_CONF="$slurm/slurm.conf"
stop() {
    for daemon in n1 n2 controller; do
        [ ! -f "$slurm/$daemon.pid" ] || kill "$(cat "$slurm/$daemon.pid")" 2>/dev/null || true
    done
}
trap stop EXIT
slurmctld -c
slurmd -N n1
slurmd -N n2

say() { printf '\n== %s\n' "$*"; }
# Waits until a command prints something, or fails after so many seconds.
wait_for() {
    left=$1
    shift
    until [ -n "$("$@" 2>/dev/null)" ]; do
        left=$((left - 1))
        [ "$left" -gt 0 ] || { echo "waited too long for: $*" >&2; exit 1; }
        sleep 1
    done
}
# The number of tasks of a job that are not finished.
unfinished() { squeue --noheader --array --job "$1" 2>/dev/null | wc -l; }
wait_until_finished() {
    while [ "$(unfinished "$1")" -gt 0 ]; do sleep 1; done
}

say "nodes"
wait_for 60 sinfo --noheader --states=idle
sinfo --Node --long

say "a sweep of $runs runs as an array of 6 tasks"
submitted=$("$here/sweep_slurm.sh" "$plan" 6 "$folder/sweep" --runs "$runs" --worst 2)
echo "$submitted"
array=$(echo "$submitted" | cut -d ' ' -f 2) merge=$(echo "$submitted" | cut -d ' ' -f 4)
wait_for 60 squeue --noheader --job "${array}_2" --states=running
wait_for 120 find "$folder/sweep/part-2" -name runs.part -size +10k
squeue --array

say "task 2 is killed: the merge cannot run"
scancel --signal=KILL --full "${array}_2"
wait_until_finished "$array"
wait_until_finished "$merge"
ls "$folder/sweep" "$folder/sweep/part-2"
[ ! -e "$folder/sweep/sweep/sweep.json" ]
echo "runs of part 2 in its journal: $(($(wc -l < "$folder/sweep/part-2/runs.part") - 2))"

say "task 2 is submitted again and goes on; then the parts are merged"
submitted=$("$here/sweep_slurm.sh" "$plan" 6 "$folder/sweep" --only 2 --runs "$runs" --worst 2)
echo "$submitted"
wait_until_finished "$(echo "$submitted" | cut -d ' ' -f 2)"
wait_until_finished "$(echo "$submitted" | cut -d ' ' -f 4)"
cat "$folder/sweep/log/merge.txt"

say "the same sweep in one go"
"$BENCHDOG" sweep "$plan" --runs "$runs" --worst 2 --out "$folder/in-one-go" > /dev/null
diff --recursive "$folder/in-one-go" "$folder/sweep/sweep"
echo "the merged sweep is the same, byte for byte: $(find "$folder/in-one-go" -type f | wc -l) files"
