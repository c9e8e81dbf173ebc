#!/usr/bin/env bash
# A study computed by one process, by processes beside each other, by Slurm and by HyperQueue: the same bytes; and with tasks and a worker
# killed in the middle, the same bytes again.
#
#     tests/cross_check/engines.sh
#
# Of $CALIPOSE, or of target/release/calipose. Slurm comes from Debian's packages (as root) and runs as one node on this machine;
# HyperQueue comes from PyPI, into $ENGINES_VENV or a temporary folder. What is out of reach is said to be NOT checked. $ENGINES_STEP is the
# step of the study in which processes are killed, in degrees: coarser than 4 where the program is not optimised.
set -euo pipefail
cd "$(dirname "$0")/../.."
calipose="$(realpath "${CALIPOSE:-target/release/calipose}")"
node="$PWD/tests/cross_check/hyperqueue_node.py"
problem="$PWD/problems/servosila-engineer.toml"
top="$(mktemp -d)"
# A name that shells, Slurm and Python read in ways of their own.
desk="$top/o'neil \"k\" \$HOME #1"
mkdir "$desk"
daemons=() nodes=()
before=$SECONDS

clean_up() {
    local status=$?
    for daemon in "${daemons[@]}"; do kill "$daemon" 2>/dev/null || true; done
    # HyperQueue's keep what would end other processes to themselves.
    for daemon in "${nodes[@]}"; do kill -KILL "$daemon" 2>/dev/null || true; done
    wait 2>/dev/null || true
    [ "$status" = 0 ] || logs
    rm -rf "$top"
}
trap clean_up EXIT

logs() {
    find "$top" -path '*/job/*' -name '*.log' -o -path '*/job/*' -name '*.err' -o -name 'slurm*.log' -o -name 'hq-*' -type f |
        while read -r file; do echo "-- ${file#"$top/"}"; tail -n 5 "$file"; done >&2
}
fail() { echo "FAILED: $*" >&2; exit 1; }
# Says what was seen, and how long it took since the last time.
seen() { echo "$* ($((SECONDS - before)) s)"; before=$SECONDS; }

# Waits until the command succeeds, for two minutes.
until_ok() {
    local what="$1" end=$((SECONDS + 120)); shift
    until "$@" >/dev/null 2>&1; do
        [ "$SECONDS" -lt "$end" ] || fail "$what: nothing after two minutes"
        sleep 0.05
    done
}

# A study of eight cells at a step.
study() {
    cat >"$desk/$1.toml" <<TOML
name = "Engines, '$1'"
problems = ["$problem"]
set = ["sweep.step_deg=$2"]
factors = [
    { key = "noise.sigma_px", values = [0.1, 0.2] },
    { key = "visibility.max_incidence_deg", range = { from = 45, to = 60, count = 4 } },
]
TOML
}

# The results of two folders.
same() {
    local file
    for file in results.csv results.parquet study.json report.html; do
        cmp "$desk/$1/$file" "$desk/$2/$file" || fail "$2/$file is not as $1 has it"
    done
}

calipose() { "$calipose" "$@" --quiet; }
submit() { "$calipose" study submit "$desk/$1.toml" --output "$desk/$2" "${@:3}" --json; }
kept() { { find "$desk/$1/cells" -name '*.json' 2>/dev/null || true; } | wc -l; }
# The names of the jobs in a document.
jobs_of() { python3 -c 'import json, sys; print(*json.load(sys.stdin)["jobs"])'; }
some_cells() { [ "$(kept "$1")" -ge "$2" ]; }
# A process that computes cells for a folder, of the program itself, not of a shell around it; with pgrep's own choices. It is stopped, so that
# it cannot end before it is killed.
task_of() {
    local task="" end=$((SECONDS + 120))
    until task="$(pgrep "${@:2}" -f "^$calipose study cell .*--output .*/$1( |\$)" | head -n 1 | grep .)" && kill -STOP "$task" 2>/dev/null; do
        [ "$SECONDS" -lt "$end" ] || fail "$1: no task within two minutes"
    done
    echo "$task"
}

study quick 20
study slow "${ENGINES_STEP:-4}"
calipose study run "$desk/quick.toml" --output "$desk/quick-run"
calipose study run "$desk/slow.toml" --output "$desk/slow-run"
seen "one process: 8 quick cells and 8 slow ones"

# On this machine.
submit quick local --engine local --shards 3 >/dev/null
same quick-run local
sh "$desk/local/job/local.sh" >/dev/null
same quick-run local
submit slow local-killed --engine local --shards 2 >/dev/null 2>"$top/said" &
until_ok "the first cell" some_cells local-killed 1
kill -KILL "$(task_of local-killed)"
wait $! && fail "a job of which a process was killed is done"
grep -q "signal: 9" "$top/said" || fail "what killed the process is not told: $(cat "$top/said")"
[ "$(kept local-killed)" -lt 8 ] || fail "the process was killed too late"
there="$(kept local-killed)"
submit slow local-killed --engine local --shards 2 >/dev/null
same slow-run local-killed
seen "local: 3 processes, the same bytes; one of 2 killed with $there of 8 cells there, submitted again, the same bytes"

slurm() {
    if [ "$(command -v slurmctld sbatch slurmd | wc -l)" -lt 3 ]; then
        if ! { apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends slurm-wlm; } \
            >"$top/apt.log" 2>&1; then
            echo "Slurm NOT checked: its packages are out of reach ($(tail -n 1 "$top/apt.log"))"
            return
        fi
        before=$SECONDS
    fi
    local host port
    host="$(hostname -s)"
    port=$((20000 + RANDOM % 10000))
    mkdir "$top/state" "$top/spool"
    cat >"$top/slurm.conf" <<CONF
ClusterName=check
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
StateSaveLocation=$top/state
SlurmdSpoolDir=$top/spool
SlurmctldPidFile=$top/slurmctld.pid
SlurmdPidFile=$top/slurmd.pid
SlurmctldLogFile=$top/slurmctld.log
SlurmdLogFile=$top/slurmd.log
SchedulerParameters=sched_min_interval=100000,batch_sched_delay=0,bf_interval=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=short Nodes=ALL MaxTime=10
PartitionName=other Nodes=ALL Default=YES State=DOWN
CONF
    export SLURM_CONF="$top/slurm.conf"
    slurmctld -D >/dev/null 2>&1 &
    daemons+=($!)
    slurmd -D -N "$host" >/dev/null 2>&1 &
    daemons+=($!)
    until_ok "Slurm's node" sh -c 'sinfo --noheader --partition=short --format=%t | grep -q idle'

    local jobs array merge
    jobs="$(submit quick slurm --engine slurm --shards 4 --option=--partition=short | jobs_of)"
    echo "Slurm: jobs $jobs"
    until_ok "the merge by Slurm" test -s "$desk/slurm/study.json"
    same quick-run slurm
    ls "$desk/slurm/job/shard-3.log" "$desk/slurm/job/merge.log" >/dev/null

    jobs="$(submit slow slurm-killed --engine slurm --shards 2 --option=--partition=short | jobs_of)"
    read -r array merge <<<"$jobs"
    until_ok "the first cell by Slurm" some_cells slurm-killed 1
    kill -KILL "$(task_of slurm-killed)"
    until_ok "the end of both jobs" sh -c "! squeue --noheader --jobs=$array,$merge | grep -q ."
    [ ! -e "$desk/slurm-killed/study.json" ] || fail "an array of which a task was killed is merged"
    [ "$(kept slurm-killed)" -lt 8 ] || fail "the task was killed too late"
    local there
    there="$(kept slurm-killed)"
    submit slow slurm-killed --engine slurm --shards 2 --option=--partition=short >/dev/null
    until_ok "the merge by Slurm" test -s "$desk/slurm-killed/study.json"
    same slow-run slurm-killed

    if submit quick slurm-refused --engine slurm --option=--partition=none 2>"$top/said"; then
        fail "a partition that is not there is taken"
    fi
    grep -q "invalid partition" "$top/said" || fail "Slurm's refusal is not told: $(cat "$top/said")"
    if submit quick '100%' --engine slurm 2>"$top/said"; then fail "a folder is taken that Slurm reads in its own way"; fi
    grep -q "Slurm reads" "$top/said" || fail "that Slurm cannot write there is not told: $(cat "$top/said")"
    seen "Slurm $(sinfo --version | cut -d ' ' -f 2): 4 tasks, the same bytes; a task killed with $there of 8 cells there and no merge, submitted" \
        "again, the same bytes; a refusal told"
}

hyperqueue() {
    local venv="${ENGINES_VENV:-$top/venv}" queue="$top/queue" job first second
    if ! { { [ -x "$venv/bin/python3" ] || python3 -m venv "$venv"; } &&
        "$venv/bin/python3" -m pip install --quiet hyperqueue==0.27.0; } >"$top/pip.log" 2>&1; then
        echo "HyperQueue NOT checked: it is out of reach ($(tail -n 1 "$top/pip.log"))"
        return
    fi
    before=$SECONDS
    if submit quick hq-missing --engine hyperqueue 2>"$top/said"; then fail "HyperQueue is found where it is not"; fi
    grep -q '"no-engine"' "$top/said" || fail "that HyperQueue is missing is not told: $(cat "$top/said")"
    export PATH="$venv/bin:$PATH" HQ_SERVER_DIR="$queue" TMPDIR="$top"
    if submit quick hq-missing --engine hyperqueue 2>"$top/said"; then fail "a server is found where there is none"; fi
    grep -q '"engine"' "$top/said" || fail "that there is no server is not told: $(cat "$top/said")"

    python3 "$node" server "$queue" >"$top/hq-server" 2>&1 &
    nodes+=($!)
    until_ok "HyperQueue's server" grep -q ready "$top/hq-server"
    python3 "$node" worker "$queue" >"$top/hq-first" 2>&1 &
    first=$!
    python3 "$node" worker "$queue" >"$top/hq-second" 2>&1 &
    second=$!
    nodes+=("$first" "$second")
    until_ok "HyperQueue's workers" grep -q ready "$top/hq-first"
    until_ok "HyperQueue's workers" grep -q ready "$top/hq-second"
    job="$(submit quick hq --engine hyperqueue --shards 4 | jobs_of)"
    python3 "$node" wait "$queue" "$job" >"$top/hq-wait" 2>&1 || fail "a task failed: $(cat "$top/hq-wait")"
    same quick-run hq
    seen "HyperQueue: job $job, 4 tasks by two workers, the same bytes"

    job="$(submit slow hq-killed --engine hyperqueue --shards 4 | jobs_of)"
    until_ok "the first cell by HyperQueue" some_cells hq-killed 1
    local task there
    task="$(task_of hq-killed -P "$first")"
    kill -KILL "$first"
    kill -KILL "$task" 2>/dev/null || true
    wait "$first" 2>/dev/null || true
    there="$(kept hq-killed)"
    [ "$there" -lt 8 ] || fail "the worker was killed too late"
    python3 "$node" wait "$queue" "$job" >"$top/hq-wait" 2>&1 || fail "a task failed: $(cat "$top/hq-wait")"
    same slow-run hq-killed
    seen "HyperQueue: a worker killed at its task with $there of 8 cells there, the other did the rest, the same bytes"
}

slurm
hyperqueue
echo "engines: $SECONDS s"
