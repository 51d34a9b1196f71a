#include "tests/support/stand_in_slurm.h"

#include "tests/support/preamble.h"
#include "tests/support/process.h"

namespace ballpiston {
namespace {

// Below $arrays is a folder for each array, NAME.NUMBER: the script, and for each task a file with
// the number of its process and the time when the process began. The system gives the number of an
// ended process to another one, perhaps to the server, which must not be killed.
constexpr char kOfAllPrograms[] = R"sh(
for word; do
  case $word in
    --job-name=* | --name=*) name=${word#*=} ;;
    --array=0-*) last=${word#--array=0-} ;;
    --wrap=*) script=${word#--wrap=} ;;
  esac
done
born() { cut -d' ' -f22 "/proc/$1/stat" 2>/dev/null; }
# Whether the process of the task's file lives; a zombie has no program. Sets $process.
lives() {
  read -r process time <"$1" && [ -n "$time" ] && [ "$(born "$process")" = "$time" ] &&
    readlink "/proc/$process/exe" >/dev/null
}
)sh";

constexpr char kSbatch[] = R"sh(
array=$arrays/$name.$$
mkdir "$array" && echo "$script" >"$array/script" || exit 1
for task in $(seq 0 "$last"); do
  echo "$name" >>"$arrays/../started"
  SLURM_ARRAY_TASK_ID=$task setsid sh "$array/script" </dev/null >/dev/null 2>&1 &
  echo "$! $(born $!)" >"$array/task.$task"
done
echo $$
)sh";

constexpr char kSqueue[] = R"sh(
for file in "$arrays/$name".*/task.*; do
  if lives "$file"; then echo "RUNNING|None"; fi
done 2>/dev/null
exit 0
)sh";

constexpr char kScancel[] = R"sh(
for file in "$arrays"/$name.*/task.*; do
  if lives "$file"; then kill -KILL "$process"; fi
done 2>/dev/null
exit 0
)sh";

}  // namespace

StandInSlurm::StandInSlurm() {
  mkdir(shared_folder().c_str(), 0700);
  mkdir(folder_.File("arrays").c_str(), 0700);
  mkdir(folder_.File("programs").c_str(), 0700);
  const auto write = [&](const std::string& name, const char* script) {
    const std::string path = folder_.File("programs/" + name);
    WriteFile(path, "#!/bin/sh\narrays='" + folder_.File("arrays") + "'" + kOfAllPrograms + script);
    chmod(path.c_str(), 0700);
  };
  write("sbatch", kSbatch);
  write("squeue", kSqueue);
  write("scancel", kScancel);
}

StandInSlurm::~StandInSlurm() {
  RunProgram({.command = {folder_.File("programs/scancel"), "--name=*"}});
}

std::vector<std::string> StandInSlurm::Launcher() const {
  return {"env", "PATH=" + folder_.File("programs") + ":" + std::getenv("PATH")};
}

int StandInSlurm::tasks() const {
  const std::string path = folder_.File("started");
  if (!std::filesystem::exists(path)) return 0;
  const std::string lines = Contents(path);
  return static_cast<int>(std::count(lines.begin(), lines.end(), '\n'));
}

}  // namespace ballpiston
