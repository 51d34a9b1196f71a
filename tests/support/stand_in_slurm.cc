#include "tests/support/stand_in_slurm.h"

#include "tests/support/preamble.h"
#include "tests/support/process.h"

namespace ballpiston {
namespace {

// A task has the name of its array in its environment. An ended process has no environment.
constexpr char kOfAllPrograms[] = R"sh(
for word; do
  case $word in
    --job-name=* | --name=*) name=${word#*=} ;;
    --array=0-*) last=${word#--array=0-} ;;
    --wrap=*) script=${word#--wrap=} ;;
  esac
done
tasks() { grep -lszx "STAND_IN_ARRAY=$folder/$name" /proc/[0-9]*/environ; }
)sh";

constexpr char kSbatch[] = R"sh(
# Starts itself again, so that tasks have the name from their first moment on.
[ -n "$STAND_IN_ARRAY" ] || STAND_IN_ARRAY=$folder/$name exec "$0" "$@"
for SLURM_ARRAY_TASK_ID in $(seq 0 "$last"); do
  export SLURM_ARRAY_TASK_ID
  echo "$name" >>"$folder/started"
  setsid sh -c "$script" </dev/null >/dev/null 2>&1 &
done
echo $$
)sh";

constexpr char kSqueue[] = R"sh(
tasks | sed 's/.*/RUNNING|None/'
)sh";

constexpr char kScancel[] = R"sh(
for task in $(tasks); do kill -KILL "$(basename "${task%/environ}")"; done 2>/dev/null
exit 0
)sh";

}  // namespace

StandInSlurm::StandInSlurm() {
  mkdir(shared_folder().c_str(), 0700);
  mkdir(folder_.File("programs").c_str(), 0700);
  const auto write = [&](const std::string& name, const char* script) {
    const std::string path = folder_.File("programs/" + name);
    WriteFile(path, "#!/bin/sh\nfolder='" + folder_.path() + "'" + kOfAllPrograms + script);
    chmod(path.c_str(), 0700);
  };
  write("sbatch", kSbatch);
  write("squeue", kSqueue);
  write("scancel", kScancel);
}

StandInSlurm::~StandInSlurm() {
  RunProgram({.command = {folder_.File("programs/scancel"), "--name=.*"}});
}

std::vector<std::string> StandInSlurm::Launcher() const {
  return {"env", "PATH=" + folder_.File("programs") + ":" + std::getenv("PATH")};
}

int StandInSlurm::tasks() const {
  const std::string lines = Contents(folder_.File("started"));
  return static_cast<int>(std::count(lines.begin(), lines.end(), '\n'));
}

}  // namespace ballpiston
