#!/bin/bash
# A Slurm cluster on this machine, for tests: munged, one slurmctld, and two nodes (one slurmd
# each). It needs no root, no systemd and no cgroups: all daemons run as the current user and accept
# only jobs of this user. All files are in DIR: configuration, state, spool, logs, keys. The daemons
# listen only on 127.0.0.1, at free ports: several clusters can run at the same time.
#
#   scripts/test-cluster.sh start DIR [--cpus N] [PARAMETER=VALUE...]
#     Starts the cluster, waits until both nodes are idle, and prints the `export` lines for the
#     tools of Slurm:  exports=$(scripts/test-cluster.sh start DIR) && eval "$exports"
#     --cpus: the CPUs that each node claims to have, by default 4.
#     PARAMETER=VALUE: a line of slurm.conf, for instance MaxArraySize=100 or MinJobAge=5.
#   scripts/test-cluster.sh stop DIR
#     Ends the processes of the cluster and of its jobs. Keeps the files. May be repeated.
#
# For tests of failures, on a running cluster:
#   kill-controller DIR      Kills slurmctld at once: its saved state may be 5 s old.
#   start-controller DIR     Starts slurmctld again, and waits until it answers.
#   pause-controller DIR     Stops slurmctld's process (SIGSTOP): connections open, but get no answer.
#   resume-controller DIR
#   lose-state DIR           Deletes the saved state. slurmctld must not run.
#   kill-node DIR n1         Kills slurmd and all processes of its jobs, as a power cut does. The node
#                            is down, and its jobs are requeued, within about 30 s. If start-node comes
#                            earlier, jobs younger than 20 s stay RUNNING for a while.
#   kill-slurmd DIR n1       Kills only slurmd. Its jobs continue, even while slurmctld starts them again
#                            on another node.
#   start-node DIR n1        Starts slurmd again, and waits until slurmctld regards the node as up.
#   kill-munge DIR, start-munge DIR
#   logs DIR                 Prints the last lines of all logs.
#
# The partitions: main (the default, at most an hour per job), spare and urgent. A job in urgent
# pre-empts (requeues) jobs in spare, but not in main.
set -euo pipefail

readonly NODES=(n1 n2)
readonly LIMIT=${BALLPISTON_CLUSTER_LIMIT:-90}  # seconds to wait for the daemons
readonly LONGEST_DIR=70                         # a socket's path has at most 107 characters
readonly PORT_ATTEMPTS=5
export PATH=$PATH:/usr/sbin:/sbin               # the path of a plain user lacks them
export LC_ALL=C

fail() {
  echo "test-cluster: $*" >&2
  exit 1
}

usage() {
  sed -n '2,/^set /{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
}

print_logs() {
  tail -n 15 "$dir"/log/*.log || true
}

fail_with_logs() {
  print_logs >&2
  fail "$*"
}

# wait_until WORDS COMMAND...: repeats the command until it succeeds. Fails after the time limit.
wait_until() {
  local words=$1 end=$((SECONDS + LIMIT))
  shift
  until "$@"; do
    ((SECONDS < end)) || fail_with_logs "after $LIMIT s still waiting for: $words (the last log lines are above)"
    sleep 0.1
  done
}

# --- Processes -----------------------------------------------------------------------------------

# A daemon's pid file contains its process id. The system reuses ids: therefore a process counts as
# the daemon only if its environment contains the mark of this cluster.
mark_of() { echo "BALLPISTON_TEST_CLUSTER=$dir/$1"; }

has_in_environment() {  # PID LINE
  grep -aqszxF -- "$2" "/proc/$1/environ"
}

# Prints the process id of a daemon: munged, slurmctld or the name of a node. Fails if the daemon
# does not run.
pid_of() {
  local pid
  { read -r pid <"$dir/pids/$1"; } 2>/dev/null || return 1
  has_in_environment "$pid" "$(mark_of "$1")" && echo "$pid"
}

runs() { pid_of "$1" >/dev/null; }

ended() { ! kill -0 "$1" 2>/dev/null || [[ $(ps -o stat= -p "$1") == Z* ]]; }

# launch NAME COMMAND...: starts a daemon in a new session.
launch() {
  local name=$1
  shift
  ! runs "$name" || fail "$name runs already"
  env "$(mark_of "$name")" setsid "$@" >>"$dir/log/$name.out.log" 2>&1 </dev/null &
  echo $! >"$dir/pids/$name"
  disown
  # From here on the mark is in the process's environment, or the process has ended.
  until runs "$name" || ended "$(<"$dir/pids/$name")"; do sleep 0.02; done
}

# signal NAME SIGNAL: does nothing if the daemon does not run.
signal() {
  local pid
  pid=$(pid_of "$1") || return 0
  kill "-$2" "$pid" 2>/dev/null || true
}

# end NAME SIGNAL: also waits until the process has ended.
end() {
  local pid
  pid=$(pid_of "$1") || return 0
  kill "-$2" "$pid" 2>/dev/null || true
  [[ $2 == KILL ]] || kill -CONT "$pid" 2>/dev/null || true
  wait_until "the end of $1 (process $pid)" ended "$pid"
  rm -f "$dir/pids/$1"
}

# A process belongs to a node's jobs if its environment names the configuration of this node's
# slurmd. Its descendants belong to the jobs too.
pids_of_jobs() {
  local node=$1 own
  own=$(grep -alszxF -- "SLURM_CONF=$(conf_of "$node")" /proc/[0-9]*/environ | tr -dc '0-9\n') || true
  ps -e -o pid= -o ppid= | awk -v own="${own//$'\n'/ }" -v slurmd="$(pid_of "$node" || true)" '
    BEGIN { count = split(own, list, " "); for (i = 1; i <= count; ++i) counts[list[i]] = 1 }
    { parent[$1] = $2 }
    END {
      do {
        grown = 0
        for (pid in parent) if (!(pid in counts) && parent[pid] in counts) { counts[pid] = 1; grown = 1 }
      } while (grown)
      for (pid in counts) if (pid != slurmd) print pid
    }'
}

# Repeats, because a process can start another one meanwhile.
kill_jobs() {
  local pids
  mapfile -t pids < <(pids_of_jobs "$1")
  ((${#pids[@]})) || return 0  # in a trap, a bare return has another meaning
  kill -KILL "${pids[@]}" 2>/dev/null
  return 1
}

kill_node() {
  end "$1" KILL
  wait_until "the end of the jobs on $1" kill_jobs "$1"
}

# --- Configuration -------------------------------------------------------------------------------

# Each slurmd reads the same file under a different name, which marks the processes of its jobs.
conf_of() { echo "$dir/$1/slurm.conf"; }

port_is_free() { ! (: <"/dev/tcp/127.0.0.1/$1") 2>/dev/null; }

# Ports below the range that the kernel gives to clients.
choose_ports() {
  local port
  ports=()
  while ((${#ports[@]} < 1 + ${#NODES[@]})); do
    port=$((10000 + RANDOM % 20000))
    [[ " ${ports[*]} " != *" $port "* ]] || continue
    if port_is_free "$port"; then ports+=("$port"); fi
  done
}

# write_conf CPUS [PARAMETER=VALUE...]
write_conf() {
  local cpus=$1 i own host
  host=$(uname -n)
  host=${host%%.*}
  shift
  own=$(
    cat <<END
AuthInfo=socket=$dir/munge.socket,cred_expire=5
AuthType=auth/munge
ClusterName=test
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
CredType=cred/munge
JobAcctGatherType=jobacct_gather/none
KillWait=5
MaxArraySize=1001
MinJobAge=10
MpiDefault=none
PreemptMode=REQUEUE
PreemptType=preempt/partition_prio
ProctrackType=proctrack/linuxproc
ReturnToService=2
SchedulerParameters=bf_interval=1,sched_interval=1
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmctldHost=$host(127.0.0.1)
SlurmctldLogFile=$dir/log/slurmctld.log
SlurmctldPidFile=$dir/slurmctld.pid
SlurmctldPort=${ports[0]}
SlurmctldTimeout=10
SlurmdLogFile=$dir/log/%n.log
SlurmdParameters=config_overrides
SlurmdPidFile=$dir/%n/slurmd.pid
SlurmdSpoolDir=$dir/%n/spool
SlurmdTimeout=10
SlurmdUser=$(id -un)
SlurmUser=$(id -un)
StateSaveLocation=$dir/state
TaskPlugin=task/none
END
  )
  {
    # The last line with a parameter's name is used. As in Slurm, the case of names does not matter.
    printf '%s\n' "$own" "$@" |
      awk -F= '{ key = tolower($1); line[key] = $0 } END { for (key in line) print line[key] }' | sort
    for i in "${!NODES[@]}"; do
      echo "NodeName=${NODES[i]} NodeHostname=$host NodeAddr=127.0.0.1 Port=${ports[i + 1]}" \
        "CPUs=$cpus RealMemory=256"
    done
    echo "PartitionName=main Nodes=ALL Default=YES MaxTime=60 PriorityTier=1 PreemptMode=OFF"
    echo "PartitionName=spare Nodes=ALL PriorityTier=1 PreemptMode=REQUEUE"
    echo "PartitionName=urgent Nodes=ALL PriorityTier=2 PreemptMode=OFF"
  } >"$dir/slurm.conf"
}

# --- The cluster ---------------------------------------------------------------------------------

controller_answers() { scontrol ping >/dev/null 2>&1; }

# node_is STATES NODE: succeeds if the node has one of these states and slurmctld reaches it (if
# not, the state has an asterisk).
node_is() {
  local state
  state=$(sinfo --noheader --nodes="$2" --partition=main --format=%T 2>/dev/null) || return 1
  [[ -n $state && " $1 " == *" $state "* ]]
}

port_is_taken() { grep -qsi 'address already in use' "$dir"/log/*.log; }

# answers NAME COMMAND...: succeeds also if the daemon has ended; the caller checks this.
answers_or_ended() {
  local name=$1
  shift
  "$@" || ! runs "$name"
}

start_munge() {
  launch munged munged --foreground --force --socket="$dir/munge.socket" --key-file="$dir/munge.key" \
    --pid-file="$dir/munged.pid" --log-file="$dir/log/munged.log" --seed-file="$dir/munge.seed"
  wait_until "munged's socket" answers_or_ended munged munge_answers
  munge_answers || fail_with_logs "munged has ended"
}

munge_answers() { munge --no-input --socket="$dir/munge.socket" >/dev/null 2>&1; }

# Fails if slurmctld ended.
launch_controller() {
  launch slurmctld slurmctld -D -f "$dir/slurm.conf"
  wait_until "slurmctld's answer" answers_or_ended slurmctld controller_answers
  runs slurmctld
}

launch_node() {
  SLURM_CONF=$(conf_of "$1") launch "$1" slurmd -D -N "$1"
}

start_controller() {
  launch_controller || fail_with_logs "slurmctld has ended"
}

start_node() {
  launch_node "$1"
  wait_until "node $1" answers_or_ended "$1" node_is "idle mixed allocated completing" "$1"
  runs "$1" || fail_with_logs "slurmd of $1 has ended"
}

# Fails if a daemon ended.
launch_all() {
  local node
  launch_controller || return 1
  for node in "${NODES[@]}"; do launch_node "$node"; done
  for node in "${NODES[@]}"; do
    wait_until "node $node to be idle" answers_or_ended "$node" node_is idle "$node"
    runs "$node" || return 1
  done
}

clear_files() {
  local node
  rm -rf "$dir"/{state,log,pids} "${NODES[@]/#/$dir/}"
  mkdir -p "$dir"/{state,log,pids}
  for node in "${NODES[@]}"; do
    mkdir -p "$dir/$node/spool"
    ln -s ../slurm.conf "$(conf_of "$node")"
  done
}

require_programs() {
  local program
  for program in munged munge slurmctld slurmd sbatch ps; do
    command -v "$program" >/dev/null || fail "$program is missing; as root, run:" \
      "apt-get install munge slurmctld slurmd slurm-client procps"
  done
}

start() {
  local cpus=4 attempt name
  if [[ ${1:-} == --cpus ]]; then
    cpus=${2:-}
    [[ $cpus =~ ^[1-9][0-9]*$ ]] || fail "--cpus '$cpus'; permitted: a number from 1"
    shift 2
  fi
  for name; do [[ $name == *?=* ]] || fail "'$name' is no PARAMETER=VALUE"; done
  require_programs
  ((${#dir} <= LONGEST_DIR)) || fail "'$dir' is too long; permitted: $LONGEST_DIR characters"
  for name in munged slurmctld "${NODES[@]}"; do
    ! runs "$name" || fail "a cluster runs already in $dir"
  done
  trap stop EXIT
  for ((attempt = 1; ; ++attempt)); do
    clear_files
    (umask 077 && head -c 128 /dev/urandom >"$dir/munge.key")
    choose_ports
    write_conf "$cpus" "$@"
    start_munge
    ! launch_all || break
    if ((attempt == PORT_ATTEMPTS)) || ! port_is_taken; then fail_with_logs "a daemon has ended"; fi
    stop
  done
  trap - EXIT
  printf 'export SLURM_CONF=%q\n' "$dir/slurm.conf"
}

# Ends the nodes first, because slurmctld would requeue jobs. Sends signals to all nodes before it
# waits for any of them.
stop() {
  local name
  for name in slurmctld munged; do
    signal "$name" TERM
    signal "$name" CONT
  done
  for name in "${NODES[@]}"; do kill_node "$name"; done
  for name in slurmctld munged; do end "$name" KILL; done
}

require_node() {
  [[ " ${NODES[*]} " == *" ${1:-} "* ]] || fail "node '${1:-}'; permitted: ${NODES[*]}"
}

[[ ${1:-} != --help ]] || { usage; exit 0; }
(($# >= 2)) || { usage >&2; exit 2; }
verb=$1
mkdir -p "$2"
dir=$(cd "$2" && pwd -P)
shift 2
[[ $dir != *[[:space:],%]* ]] || fail "'$dir': the name must not contain white space, commas or %"
# The caller may have set these variables for another cluster.
unset "${!SLURM_@}" "${!SBATCH_@}" "${!SQUEUE_@}" "${!SINFO_@}"
export SLURM_CONF=$dir/slurm.conf
ports=()

case $verb in
  start) start "$@" ;;
  stop) stop ;;
  kill-controller) end slurmctld KILL ;;
  start-controller) start_controller ;;
  pause-controller) signal slurmctld STOP ;;
  resume-controller) signal slurmctld CONT ;;
  lose-state)
    ! runs slurmctld || fail "slurmctld runs"
    rm -rf "$dir"/state/*
    ;;
  kill-node) require_node "$@" && kill_node "$1" ;;
  kill-slurmd) require_node "$@" && end "$1" KILL ;;
  start-node) require_node "$@" && start_node "$1" ;;
  kill-munge) end munged KILL ;;
  start-munge) start_munge ;;
  logs) print_logs ;;
  *) fail "unknown verb '$verb'; see --help" ;;
esac
