#!/bin/sh
# A sweep as a Slurm job array: one task a part, and a job that merges the parts when all have succeeded.
#
#     tools/sweep_slurm.sh PLAN PARTS DIR [OPTION OF benchdog sweep ...]
#
# PLAN     a plan file that all nodes can read (plan once: benchdog plan SCENARIO -o plan.json)
# PARTS    the number of parts
# DIR      a folder that all nodes can write: parts in DIR/part-M, the sweep in DIR/sweep, output of the jobs in DIR/log
#
# Prints the numbers of the two jobs. A task that was killed goes on where it ended if it is submitted again:
#
#     tools/sweep_slurm.sh PLAN PARTS DIR --only M [...]
#
# `benchdog` is that of BENCHDOG, or of PATH. SBATCH_* variables set further options of sbatch, such as SBATCH_PARTITION.
set -eu
if [ $# -lt 3 ]; then
    sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
plan=$(realpath "$1") parts=$2 folder=$(realpath -m "$3")
shift 3
tasks="1-$parts"
if [ "${1-}" = --only ]; then
    tasks=$2
    shift 2
fi
benchdog=$(command -v "${BENCHDOG:-benchdog}") || { echo "benchdog: not found; set BENCHDOG" >&2; exit 2; }
benchdog=$(realpath "$benchdog")
mkdir -p "$folder/log"

# The options become words of the job's script.
options=""
for option in "$@"; do
    options="$options '$(printf %s "$option" | sed "s/'/'\\\\''/g")'"
done

array=$(sbatch --parsable --job-name=sweep --array="$tasks" --output="$folder/log/part-%a.txt" <<EOF
#!/bin/sh
exec '$benchdog' sweep '$plan' --shard "\$SLURM_ARRAY_TASK_ID/$parts" --jobs "\${SLURM_CPUS_PER_TASK:-1}" \\
    --out '$folder/part-'"\$SLURM_ARRAY_TASK_ID" $options
EOF
)
merge=$(sbatch --parsable --job-name=merge --dependency="afterok:$array" --kill-on-invalid-dep=yes \
    --output="$folder/log/merge.txt" <<EOF
#!/bin/sh
cd '$folder' && exec '$benchdog' merge $(seq -f 'part-%g' -s ' ' 1 "$parts") --out sweep
EOF
)
echo "array $array merge $merge"
