#!/usr/bin/env bash
# A study that is ended at any moment, or finds no room on the disk, goes on where it was and ends with the bytes of an unbroken run; and two
# runs do not work in one folder at once.
#
#     tests/cross_check/study_resume.sh
#
# Of $CALIPOSE, or of target/release/calipose. $KILLS (50) runs are killed, at moments that $SEED draws.
set -euo pipefail
cd "$(dirname "$0")/../.."
calipose="$(realpath "${CALIPOSE:-target/release/calipose}")"
kills="${KILLS:-50}"
RANDOM="${SEED:-1}"
top="$(mktemp -d)"
disk=""

clean_up() {
    [ -z "$disk" ] || umount "$disk"
    rm -rf "$top"
}
trap clean_up EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }

cat >"$top/study.toml" <<TOML
name = "Resumed"
problems = ["$PWD/problems/servosila-engineer.toml"]
set = ["sweep.step_deg=30"]
factors = [
    { key = "noise.sigma_px", values = [0.1, 0.2, 0.3] },
    { key = "visibility.max_incidence_deg", range = { from = 40, to = 60, count = 20 } },
]
TOML

run() { "$calipose" study run "$top/study.toml" --output "$1" --quiet; }
kept() { { find "$1/cells" -name '*.json' 2>/dev/null || true; } | wc -l; }
same() {
    local file
    for file in results.csv results.parquet study.json report.html; do
        cmp "$top/whole/$file" "$1/$file" || fail "$file is not as an unbroken run has it"
    done
    diff <(cd "$top/whole/figures" && sha256sum -- *) <(cd "$1/figures" && sha256sum -- *) >/dev/null ||
        fail "the figures are not as an unbroken run has them"
    # Times differ; what else is there is the same, and nothing is left over.
    diff <(cd "$top/whole" && find . -type f | sort) <(cd "$1" && find . -type f | sort) || fail "the files are not the same"
}
milliseconds() { echo $(($(date +%s%N) / 1000000)); }

start="$(milliseconds)"
run "$top/whole"
whole=$(($(milliseconds) - start))
cells="$(kept "$top/whole")"
[ "$cells" = 60 ] || fail "$cells cells"
echo "an unbroken run: $cells cells in $whole ms"

# A kill comes at a moment within most of an unbroken run's time. The folder is emptied when its study is done.
killed=0 finished=0 computing=0 merging=0
while [ "$killed" -lt "$kills" ]; do
    "$calipose" study run "$top/study.toml" --output "$top/broken" --quiet &
    process=$!
    sleep "$(awk "BEGIN { print $RANDOM / 32768 * 0.8 * $whole / 1000 }")"
    if ! kill -KILL "$process" 2>/dev/null; then
        wait "$process"
        same "$top/broken"
        finished=$((finished + 1))
        rm -rf "$top/broken"
        continue
    fi
    wait "$process" 2>/dev/null || true
    killed=$((killed + 1))
    there="$(kept "$top/broken")"
    if [ "$there" = "$cells" ]; then merging=$((merging + 1)); elif [ "$there" -gt 0 ]; then computing=$((computing + 1)); fi
    if [ "$there" = "$cells" ]; then
        # What was killed while it merged is merged by the next.
        run "$top/broken"
        same "$top/broken"
        rm -rf "$top/broken"
    fi
done
run "$top/broken"
same "$top/broken"
[ "$kills" -lt 30 ] || { [ "$computing" -gt 0 ] && [ "$merging" -gt 0 ]; } || fail "no kill came while it computed, or none while it merged: draw other moments with SEED"
echo "killed $killed times: $computing while it computed, $merging while it merged, the others before a cell was there; $finished runs were done" \
    "before; each time the bytes of an unbroken run"

# A full disk: a small one where it can be mounted, else no file that takes more than a block.
mkdir "$top/disk"
if mount -t tmpfs -o size=160k tmpfs "$top/disk" 2>/dev/null; then
    disk="$top/disk"
    status=0
    run "$disk/results" 2>"$top/said" || status=$?
    cat "$top/said"
    [ "$status" = 1 ] || fail "exit code $status on a full disk"
    grep -q "cannot write" "$top/said" && grep -q "No space left" "$top/said" && grep -q "are kept" "$top/said" || fail "the message is not clear"
    there="$(kept "$disk/results")"
    [ "$there" -gt 0 ] && [ "$there" -lt "$cells" ] || fail "$there of $cells cells are kept on a full disk"
    mount -o remount,size=32m "$disk"
    "$calipose" study cell "$top/study.toml" --shard 0/1 --output "$disk/results" --json >"$top/counted"
    grep -q "\"computed\": $((cells - there))" "$top/counted" || fail "not all of $there cells were kept: $(cat "$top/counted")"
    run "$disk/results"
    same "$disk/results"
    echo "a full disk: the message above, $there of $cells cells kept, and with space the bytes of an unbroken run"
else
    echo "a full disk NOT checked: nothing can be mounted here"
fi
status=0
(ulimit -f 8 && trap '' XFSZ && run "$top/limited") 2>"$top/said" || status=$?
cat "$top/said"
[ "$status" = 1 ] || fail "exit code $status where no file may be large"
grep -q "cannot write" "$top/said" && grep -q "File too large" "$top/said" || fail "the message is not clear"
there="$(kept "$top/limited")"
[ "$there" = "$cells" ] || fail "$there of $cells cells are kept where no large file can be written"
[ ! -e "$top/limited/study.json" ] || fail "a study is there that was not merged"
run "$top/limited"
same "$top/limited"
echo "no large file: the message above, all $there cells kept, and then the bytes of an unbroken run"

# Two at once, the first held still.
"$calipose" study run "$top/study.toml" --output "$top/both" --quiet &
process=$!
until [ "$(kept "$top/both")" -gt 0 ]; do sleep 0.01; done
kill -STOP "$process"
for command in "study run" "study merge" "study cell --shard 0/2" "study submit --engine local"; do
    status=0
    # shellcheck disable=SC2086
    "$calipose" $command "$top/study.toml" --output "$top/both" --quiet 2>"$top/said" || status=$?
    [ "$status" = 1 ] && grep -q "another run is at work" "$top/said" || fail "$command beside a run: exit code $status, $(cat "$top/said")"
done
cat "$top/said"
kill -CONT "$process"
wait "$process"
same "$top/both"
echo "two runs at once: the second is refused as above, whatever it is, and the first ends with the bytes of an unbroken run"
echo "study_resume: $SECONDS s"
