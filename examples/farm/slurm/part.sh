#!/usr/bin/env bash
# A task of submit.sh: makes the frames of one part, or those that are missing.
#
#     part.sh SCENE PARTS FIRST LAST PART [options]
set -euo pipefail
scene=$1 parts=$2 first=$3 last=$4 part=$5
shift 5
begin=$((first + SLURM_ARRAY_TASK_ID * part))
end=$((begin + part - 1))
[ "$end" -le "$last" ] || end=$last
exec "${PCMVS:-pcmvs}" reconstruct "$scene" -o "$parts/$(printf %05d "$SLURM_ARRAY_TASK_ID")" \
    --frames "$begin..$end" --threads "${SLURM_CPUS_PER_TASK:-${SLURM_CPUS_ON_NODE:-1}}" "$@"
