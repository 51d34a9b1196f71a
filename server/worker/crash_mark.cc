#include "server/worker/crash_mark.h"

#include <fcntl.h>
#include <limits.h>
#include <unistd.h>

#include <array>

#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

std::array<char, PATH_MAX> path_of_mark = {};  // empty: none

}  // namespace

std::string CrashMarkFile(const std::string& folder, size_t task, size_t lease) {
  return absl::StrCat(folder, "/task-", task, ".lease-", lease, ".crash");
}

void SetCrashMark(const std::string& folder, size_t task, size_t lease) {
  const std::string path = CrashMarkFile(folder, task, lease);
  path_of_mark = {};
  if (path.size() < path_of_mark.size()) path.copy(path_of_mark.data(), path.size());
}

void LeaveCrashMark(int) {
  const int file = open(path_of_mark.data(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0) return;
  fsync(file);
  close(file);
}

}  // namespace ballpiston::server
