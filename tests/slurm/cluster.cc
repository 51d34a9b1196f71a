#include "tests/slurm/cluster.h"

#include <cctype>
#include <system_error>

namespace ballpiston {
namespace {

std::string Script() { return SourcePath("scripts/test-cluster.sh"); }

void Run(std::vector<std::string> words) {
  const ProcessResult result = RunProgram({.command = words});
  if (result.exit_code == 0) return;
  throw std::runtime_error(absl::StrCat(words[1], " failed: ", result.err));
}

// Empty if the process ends meanwhile.
std::string CommandLineOf(const std::filesystem::path& process) {
  std::ostringstream text;
  text << std::ifstream(process / "cmdline", std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace

Cluster::Cluster(const std::vector<std::string>& parameters) {
  const std::string folder = folder_.File("cluster");
  const std::string stop =
      absl::StrCat("cat >/dev/null; exec '", Script(), "' stop '", folder, "'");
  keeper_.reset(popen(stop.c_str(), "we"));
  if (keeper_ == nullptr) throw std::runtime_error("no shell");
  std::vector<std::string> words = {Script(), "start", folder};
  words.insert(words.end(), parameters.begin(), parameters.end());
  Run(words);
}

void Cluster::Do(const std::string& verb, const std::string& node) const {
  std::vector<std::string> words = {Script(), verb, folder_.File("cluster")};
  if (!node.empty()) words.push_back(node);
  Run(words);
}

ProcessResult Cluster::Tool(std::vector<std::string> words) const {
  return RunProgram({.command = std::move(words), .environment = {{"SLURM_CONF", conf()}}});
}

std::vector<std::string> Cluster::Queue() const {
  return absl::StrSplit(Tool({"squeue", "--noheader", "-r", "--format=%F|%K|%j|%T|%r"}).out, '\n',
                        absl::SkipEmpty());
}

std::vector<pid_t> ProcessesWith(const std::string& text) {
  std::vector<pid_t> found;
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", gone)) {
    const std::string name = entry.path().filename();
    if (!std::all_of(name.begin(), name.end(), [](char c) { return std::isdigit(c); })) continue;
    if (absl::StrContains(CommandLineOf(entry.path()), text)) found.push_back(std::stoi(name));
  }
  return found;
}

}  // namespace ballpiston
