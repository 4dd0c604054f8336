#!/usr/bin/env bash
# Reconstructs a clip on a Slurm cluster: the tasks of a job array make its parts, and a last job joins them.
#
#     examples/farm/slurm/submit.sh SCENE OUT FIRST LAST PART [options of `pcmvs reconstruct`]
#
# makes the frames FIRST to LAST, PART of them per task. SCENE and OUT are on a file system that all nodes share. The
# program is `pcmvs` on the PATH of the nodes, or what PCMVS names. Options of sbatch, such as a partition or the number of
# processors of a task, go into SBATCH_OPTIONS: SBATCH_OPTIONS="--partition=cpu --cpus-per-task=8".
#
# Prints the number of the array and that of the last job. A task whose node fails is run again by Slurm, and goes on with
# the frames that are missing. Run the same command again to remake what has changed.
set -euo pipefail
[ $# -ge 5 ] || { sed -n '2,/^set/p' "$0" | sed '$d; s/^# \{0,1\}//' >&2; exit 2; }
scene=$(realpath "$1") out=$(realpath -m "$2") first=$3 last=$4 part=$5
shift 5
here=$(cd "$(dirname "$0")" && pwd)
tasks=$(((last - first) / part + 1))
mkdir -p "$out.parts/log"

# shellcheck disable=SC2086  # SBATCH_OPTIONS is a list of words.
array=$(sbatch --parsable ${SBATCH_OPTIONS:-} --job-name=pcmvs --requeue --open-mode=append \
    --array="0-$((tasks - 1))" --output="$out.parts/log/part_%a.txt" \
    "$here/../part.sh" "$scene" "$out.parts" "$first" "$last" "$part" "$@")
# shellcheck disable=SC2086
join=$(sbatch --parsable ${SBATCH_OPTIONS:-} --job-name=pcmvs-join --requeue --open-mode=append \
    --dependency="afterok:$array" --kill-on-invalid-dep=yes --output="$out.parts/log/join.txt" \
    "$here/../join.sh" "$out.parts" "$out" "$first" "$last" "$tasks")
echo "$array $join"
