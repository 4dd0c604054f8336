#!/usr/bin/env bash
# The last task of a farm: joins the parts. Nothing is left out without a word, see `pcmvs join --help`.
#
#     join.sh PARTS OUT FIRST LAST TASKS
set -euo pipefail
parts=$1 out=$2 first=$3 last=$4 tasks=$5
folders=()
for ((i = 0; i < tasks; i++)); do folders+=("$parts/$(printf %05d "$i")"); done
exec "${PCMVS:-pcmvs}" join "${folders[@]}" -o "$out" --frames "$first..$last"
