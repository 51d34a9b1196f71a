#include "server/cluster/cluster_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "server/worker/shared_files.h"

namespace ballpiston::server {
namespace {

absl::Status Unusable(const std::string& path, int error) {
  const std::string why = absl::StrCat(path, ": ", std::strerror(error));
  const bool is_full = error == ENOSPC || error == EDQUOT;
  return is_full ? absl::ResourceExhaustedError(why) : absl::UnavailableError(why);
}

absl::Status Refused(const std::string& path, const std::string& why) {
  return absl::FailedPreconditionError(absl::StrCat(path, " ", why));
}

absl::Status CheckOwner(const std::string& path) {
  struct stat found {};
  if (stat(path.c_str(), &found) != 0) return Unusable(path, errno);
  if (!S_ISDIR(found.st_mode)) return Refused(path, "is not a folder");
  if (found.st_uid != geteuid()) {
    return Refused(path, absl::StrCat("belongs to user ", found.st_uid,
                                      ", not to this server's user ", geteuid()));
  }
  if ((found.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
    return Refused(path, absl::StrFormat("can be written by other users (mode %04o): chmod go-w",
                                         found.st_mode & 07777));
  }
  return absl::OkStatus();
}

absl::Status MakeFolder(const std::string& path) {
  if (mkdir(path.c_str(), 0700) == 0 || errno == EEXIST) return absl::OkStatus();
  return Unusable(path, errno);
}

absl::StatusOr<std::string> BytesOf(const std::string& path) {
  const std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();  // fails if the file is empty or cannot be read, such as a folder
  if (!bytes) return absl::NotFoundError(absl::StrCat(path, " cannot be read"));
  return std::move(bytes).str();
}

// Beside this program, as in a build folder, or in libexec, as installed.
std::string InstalledWorker() {
  std::error_code error;
  const std::filesystem::path folder =
      std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const std::filesystem::path beside = folder / "ballpiston-worker";
  if (std::filesystem::exists(beside, error)) return beside;
  return folder.parent_path() / "libexec/ballpiston/ballpiston-worker";
}

// One of two servers that begin with an empty folder makes the file.
absl::Status CheckOwnerFile(const std::string& folder, const std::string& identity) {
  FolderFiles files(folder);
  const absl::Status made = files.Create("owner", identity).status();
  const absl::StatusOr<std::string> found = files.Read("owner", 0);
  if (!found.ok()) return made.ok() ? found.status() : made;
  if (*found == identity) return absl::OkStatus();
  return Refused(folder,
                 absl::StrCat("is in use by another server (", *found, "; this one is ", identity,
                              "): use another folder, or remove the file owner "
                              "if that server is gone"));
}

}  // namespace

absl::Status PrepareFolder(const std::string& folder, const std::string& identity) {
  if (!absl::StartsWith(folder, "/")) return Refused(folder, "is not an absolute path");
  absl::Status status = CheckOwner(folder);
  if (status.ok()) status = CheckOwnerFile(folder, identity);
  for (const char* subfolder : {"todo", "taken", "done", "log"}) {
    const std::string path = absl::StrCat(folder, "/", subfolder);
    if (status.ok()) status = MakeFolder(path);
    if (status.ok()) status = CheckOwner(path);
  }
  return status;
}

absl::Status CopyWorker(const std::string& folder, const std::string& worker) {
  const std::string name = "ballpiston-worker", part = name + ".new";
  FolderFiles files(folder);
  const absl::StatusOr<std::string> bytes = BytesOf(worker.empty() ? InstalledWorker() : worker);
  const absl::StatusOr<std::string> copy = BytesOf(files.PathOf(name));
  if (!bytes.ok()) return bytes.status();
  if (copy.ok() && *copy == *bytes) return absl::OkStatus();
  files.Remove(part).IgnoreError();  // of an attempt that failed
  const absl::Status made = files.Create(part, *bytes).status();
  if (!made.ok()) return made;
  if (chmod(files.PathOf(part).c_str(), 0700) != 0) return Unusable(files.PathOf(part), errno);
  return files.Move(part, name);
}

}  // namespace ballpiston::server
