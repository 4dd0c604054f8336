#!/usr/bin/env bash
# Follows a clip that submit.sh has sent: prints how many frames are finished, until the clip is joined or a job has failed.
#
#     follow.sh OUT ARRAY JOIN     (the numbers that submit.sh has printed)
set -euo pipefail
[ $# -eq 3 ] || { sed -n '2,/^set/p' "$0" | sed '$d; s/^# \{0,1\}//' >&2; exit 2; }
out=$(realpath -m "$1") array=$2 join=$3
while squeue --noheader --jobs="$array,$join" 2>/dev/null | grep -q .; do
    done=$(find "$out.parts" -mindepth 2 -name 'frame_*' ! -name '.*' 2>/dev/null | wc -l)
    states=$(squeue --noheader --array --jobs="$array" --format=%T 2>/dev/null | sort | uniq -c | tr -s ' \n' ' ')
    echo "$done frames;$states"
    sleep "${INTERVAL:-10}"
done
if [ -f "$out/sequence.json" ] && grep -q 'frames of' "$out.parts/log/join.txt"; then
    tail -n 1 "$out.parts/log/join.txt"
else
    echo "the clip was not joined: see $out.parts/log" >&2
    exit 1
fi
