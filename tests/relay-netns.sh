#!/usr/bin/env bash
# The relay between two machines, as far as one machine can play two: two network namespaces, joined by a pair of
# interfaces with a delay of 1 ms each way and 100 Mbit/s: veth with netem where the kernel has it, tests/relay_link.py
# where it does not. Shows that answers are to the bit those of a local run,
# what a link that is cut in mid-window and a wrong key end in, and what an iteration costs.
#
#   cargo build --release --workspace --bins && tests/relay-netns.sh [all|same|cut|key|cost]
#
# Needs root, for the namespaces, and ip and tc (iproute2). Nothing leaves the namespaces.
set -euo pipefail
cd "$(dirname "$0")/.."
what=${1:-all}
if [ "$(id -u)" != 0 ] || ! command -v ip >/dev/null || ! command -v tc >/dev/null; then
  echo "skipped: network namespaces need root, and ip and tc (iproute2)" >&2
  exit 0
fi
programs=$PWD/target/release
tag=cosim$$
home=${tag}h far=${tag}f
work=$(mktemp -d); shm=$(mktemp -d -p /dev/shm ct-XXXXXX)
mkdir "$shm/home" "$shm/far"
far_pid="" link_pid=""
clean() {
  if [ -n "$far_pid" ]; then kill -TERM "$far_pid" 2>/dev/null || true; wait "$far_pid" 2>/dev/null || true; fi
  unlink_both
  ip netns del "$home" 2>/dev/null || true
  ip netns del "$far" 2>/dev/null || true
  rm -rf "$work" "$shm"
}
trap clean EXIT

ip netns add "$home"; ip netns add "$far"
for space in "$home" "$far"; do ip -n "$space" link set lo up; done
# Joins the two, slowly or not at all so.
link_both() {
  local netem=(netem delay 1ms rate 100mbit limit 1000)
  kind="veth"
  if [ "$1" = slow ] && ! tc -n "$home" qdisc add dev lo root "${netem[@]}" 2>/dev/null; then
    kind="relay_link.py (this kernel has no netem)"
    python3 tests/relay_link.py "$home" "$far" 1 100 >"$work/link" &
    link_pid=$!
    for _ in $(seq 100); do grep -qs ready "$work/link" && break; sleep 0.05; done
  else
    tc -n "$home" qdisc del dev lo root 2>/dev/null || true
    ip -n "$home" link add v0 type veth peer name v0 netns "$far"
    [ "$1" != slow ] || for space in "$home" "$far"; do tc -n "$space" qdisc add dev v0 root "${netem[@]}"; done
  fi
  for one in "$home 10.77.0.1" "$far 10.77.0.2"; do
    local space address
    read -r space address <<<"$one"
    ip -n "$space" addr add "$address/24" dev v0
    ip -n "$space" link set v0 up
  done
  local sent=""; ! command -v ping >/dev/null || sent="; ping $(ip netns exec "$home" ping -c 5 -i 0.2 -q 10.77.0.2 | tail -1)"
  echo "# link: $1, $kind$sent"
}
unlink_both() {
  if [ -n "$link_pid" ]; then kill "$link_pid" 2>/dev/null || true; wait "$link_pid" 2>/dev/null || true; link_pid=""; fi
  ip -n "$home" link del v0 2>/dev/null || true
}

"$programs/cosim-relay" --new-key "$work/key"
"$programs/cosim-relay" --new-key "$work/other"
at_home() { COSIM_RUNTIME_DIR="$shm/home" ip netns exec "$home" "$programs/coordinator" "$@"; }

# Starts the far end of a program and its arguments, in one word; further words are options.
begin() {
  local program=$1; shift
  COSIM_RUNTIME_DIR="$shm/far" ip netns exec "$far" "$programs/cosim-relay" --listen 10.77.0.2:7447 --key "$work/key" "$@" \
    -- $program 2>"$work/far.log" &
  far_pid=$!
  for _ in $(seq 200); do grep -qs "listening" "$work/far.log" && return; sleep 0.05; done
  echo "the far end does not listen" >&2; cat "$work/far.log" >&2; exit 1
}
end() {
  kill -TERM "$far_pid"; wait "$far_pid" || true; far_pid=""
  [ -z "$(ls -A "$shm/far" "$shm/home" | grep cosim || true)" ] || { echo "left behind: $(ls -R "$shm")" >&2; exit 1; }
}
# The key of a role's command.
command_of() { # role, options
  local role=$1; shift
  local words='"cosim-relay", "--connect", "10.77.0.2:7447", "--key", "'$work/key'"'
  for word in "$@"; do words+=", \"$word\""; done
  echo "$role.command=[$words]"
}

# Figures, fields and iterations of two results are the same to the bit; times and the command are not compared.
compare() {
  python3 - "$1" "$2" <<'PY'
import csv, json, pathlib, sys
def results(folder):
    folder = pathlib.Path(folder)
    summary = json.load(open(folder / "summary.json")); summary.pop("cost")
    rows = list(csv.reader(open(folder / "iterations.csv")))
    kept = [i for i, head in enumerate(rows[0]) if not head.endswith("_s") or head in ("start_s", "end_s")]
    table = [[row[i] for i in kept] for row in rows]
    fields = {p.name: p.read_bytes() for p in sorted((folder / "fields").glob("*"))}
    return summary, table, fields
here, there = results(sys.argv[1]), results(sys.argv[2])
same = here == there
print("same to the bit" if same else "DIFFERENT", f"({len(here[1]) - 1} iterations, {len(here[2])} files of fields)")
sys.exit(not same)
PY
}

same() {
  for one in "wheel-rail thermal thermal-solver" "falling-friction thermal thermal-solver" "falling-friction mech mech-solver"; do
    read -r name role program <<<"$one"
    at_home run "cases/$name.toml" --set output.fields=all --out "$work/here" --replace --quiet
    begin "$program"
    at_home run "cases/$name.toml" --set output.fields=all --set "$(command_of "$role")" --out "$work/there" --replace --quiet
    end
    printf '%-17s %-8s far: ' "$name" "$role"; compare "$work/here" "$work/there"
  done
}

cut() {
  begin "toy left"
  at_home run cases/exchange.toml --set left.delay=600 --set "$(command_of left)" --out "$work/cut" --replace 2>"$work/cut.err" &
  local run=$!
  for _ in $(seq 400); do grep -q "every participant is ready" "$work/cut/log.jsonl" 2>/dev/null && break; sleep 0.05; done
  sleep 0.5
  ip -n "$home" link set v0 down
  local began; began=$(date +%s.%N)
  local code=0; wait "$run" || code=$?
  printf 'link cut in mid-window: exit code %s after %.1f s\n  home: ' "$code" "$(echo "$(date +%s.%N) - $began" | bc -l 2>/dev/null || python3 -c "import time; print(time.time() - $began)")"
  grep "^error" "$work/cut.err"
  for _ in $(seq 200); do grep -q "the run is over" "$work/far.log" && break; sleep 0.1; done
  printf '  far: '; grep "the run is over" "$work/far.log"
  end
  ip -n "$home" link set v0 up
  [ "$code" = 1 ]
}

key() {
  begin "toy left"
  local code=0
  at_home run cases/exchange.toml --set "$(command_of left | sed "s#$work/key#$work/other#")" --out "$work/wrong" --replace 2>"$work/wrong.err" || code=$?
  printf 'wrong key: exit code %s\n  home: ' "$code"; grep "^error" "$work/wrong.err"
  printf '  far: '; grep "refused" "$work/far.log"
  end
  [ "$code" != 0 ]
}

# Microseconds of an iteration, the median: values of full precision that have little in common, so many each way.
iteration() { # values, windows, settings...
  local values=$1 windows=$2; shift 2
  at_home run cases/linear.toml --set linear.problem=diagonal --set "linear.size=$values" --set coupling.scheme=serial-explicit \
    --set "time.end=$windows" "$@" --out "$work/cost" --replace --quiet >/dev/null
  python3 - "$work/cost/iterations.csv" <<'PY'
import csv, statistics, sys
rows = list(csv.DictReader(open(sys.argv[1])))[1:]
of = lambda row: float(row["coupling_s"]) + float(row["relay_s"]) + float(row["operator_s"])
print(f"{1e6 * statistics.median(map(of, rows)):.0f}")
PY
}

cost() {
  for speed in fast slow; do
    unlink_both; link_both "$speed"
    begin "toy operator"
    echo "us per iteration: one field each way, one participant far"
    printf '%9s %10s %10s %10s\n' values local none lz4
    for one in "1000 200" "10000 100" "100000 20" "1000000 6"; do
      read -r values windows <<<"$one"
      printf '%9s %10s' "$values" "$(iteration "$values" "$windows")"
      for compress in none lz4; do
        printf ' %10s' "$(iteration "$values" "$windows" --set "$(command_of operator --compress "$compress")")"
      done
      echo
    done
    end
  done
}

case $what in
  all) link_both slow; same; cut; key; cost ;;
  same | cut | key) link_both slow; "$what" ;;
  cost) cost ;;
  *) echo "usage: $0 [all|same|cut|key|cost]" >&2; exit 2 ;;
esac
