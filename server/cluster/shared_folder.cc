#include "server/cluster/shared_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "server/sha256.h"
#include "server/store/folder_sync.h"

namespace ballpiston::server {
namespace {

namespace fs = std::filesystem;

absl::Status Unusable(const std::string& path, int error) {
  const std::string why = absl::StrCat("shared folder: ", path, ": ", std::strerror(error));
  const bool is_full = error == ENOSPC || error == EDQUOT;
  return is_full ? absl::ResourceExhaustedError(why) : absl::UnavailableError(why);
}

absl::Status Refused(const std::string& path, const std::string& why) {
  return absl::FailedPreconditionError(absl::StrCat("shared folder: ", path, " ", why));
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
  std::ifstream file(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file || bytes.empty()) return absl::NotFoundError(absl::StrCat(path, " cannot be read"));
  return bytes;
}

// If the copy fails, its part is removed: the disk may be full.
absl::Status WriteProgram(const std::string& path, const std::string& bytes) {
  const std::string temporary = absl::StrCat(path, ".new");
  absl::Cleanup remove = [&] { unlink(temporary.c_str()); };
  {
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.flush();
    if (!file) return Unusable(temporary, errno);
  }
  if (chmod(temporary.c_str(), 0700) != 0) return Unusable(temporary, errno);
  if (rename(temporary.c_str(), path.c_str()) != 0) return Unusable(path, errno);
  std::move(remove).Cancel();
  return absl::OkStatus();
}

}  // namespace

std::string TaskFileIn(const std::string& array_folder) {
  return absl::StrCat(array_folder, "/tasks");
}

SharedFolder::SharedFolder(std::string folder, std::string identity)
    : shared_(std::move(folder)), own_(absl::StrCat(shared_, "/", identity)) {}

absl::Status SharedFolder::Prepare() const {
  if (!absl::StartsWith(shared_, "/")) return Refused(shared_, "is not an absolute path");
  absl::Status status = CheckOwner(shared_);
  if (status.ok()) status = MakeFolder(own_);
  if (status.ok()) status = CheckOwner(own_);
  return status;
}

absl::StatusOr<std::string> SharedFolder::CopyWorker(const std::string& program) const {
  const absl::StatusOr<std::string> bytes = BytesOf(program);
  if (!bytes.ok()) return bytes.status();
  const std::string hash = Sha256(*bytes);
  std::string name = absl::StrCat(own_, "/ballpiston-worker-");
  for (size_t i = 0; i < 8; ++i)
    absl::StrAppendFormat(&name, "%02x", static_cast<uint8_t>(hash[i]));
  const absl::StatusOr<std::string> copy = BytesOf(name);
  if (copy.ok() && *copy == *bytes) return name;
  const absl::Status written = WriteProgram(name, *bytes);
  if (!written.ok()) return written;
  return name;
}

std::string SharedFolder::PathOf(const std::string& array) const {
  return absl::StrCat(own_, "/", array);
}

absl::Status SharedFolder::MakeArray(const std::string& array) const {
  const std::string path = PathOf(array);
  return mkdir(path.c_str(), 0700) == 0 ? absl::OkStatus() : Unusable(path, errno);
}

void SharedFolder::RemoveArray(const std::string& array) const {
  std::error_code ignored;
  fs::remove_all(PathOf(array), ignored);
}

absl::StatusOr<std::vector<std::string>> SharedFolder::ListArrays(const std::string& prefix) const {
  std::error_code error;
  std::vector<std::string> arrays;
  for (fs::directory_iterator entry(own_, error), end; !error && entry != end;
       entry.increment(error)) {
    std::string name = entry->path().filename().string();
    std::error_code unknown;  // of a broken link, which is not an array
    const bool is_folder = entry->is_directory(unknown) && !entry->is_symlink(unknown);
    if (absl::StartsWith(name, prefix) && is_folder) {
      arrays.push_back(std::move(name));
    }
  }
  if (error) return Unusable(own_, error.value());
  return arrays;
}

}  // namespace ballpiston::server
