#!/usr/bin/env bash
# A task of a farm: makes the frames of one part of a clip, or those of them that are missing.
#
#     part.sh SCENE PARTS FIRST LAST PART [options of `pcmvs reconstruct`]
#
# The index of the part is in INDEX, or where Slurm or Kubernetes give it.
set -euo pipefail
scene=$1 parts=$2 first=$3 last=$4 part=$5
shift 5
index=${INDEX:-${SLURM_ARRAY_TASK_ID:-$JOB_COMPLETION_INDEX}}
begin=$((first + index * part))
end=$((begin + part - 1))
[ "$end" -le "$last" ] || end=$last
exec "${PCMVS:-pcmvs}" reconstruct "$scene" -o "$parts/$(printf %05d "$index")" --frames "$begin..$end" \
    --threads "${THREADS:-${SLURM_CPUS_PER_TASK:-${SLURM_CPUS_ON_NODE:-1}}}" "$@"
