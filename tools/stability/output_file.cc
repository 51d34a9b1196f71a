#include "tools/stability/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"

namespace ballpiston::stability {
namespace {

absl::Status CannotWrite(const std::string& path, const std::string& reason) {
  return absl::FailedPreconditionError(absl::StrCat("cannot write ", path, ": ", reason));
}

std::string ErrorText(int error) { return std::generic_category().message(error); }

// The file that is to be replaced or created.
struct Target {
  std::string path;                   // all symbolic links are resolved
  std::optional<mode_t> permissions;  // of the old file, if there is one
};

absl::StatusOr<Target> FindTarget(const std::string& path) {
  std::error_code missing;
  std::filesystem::path place = std::filesystem::canonical(path, missing);
  if (missing) place = path;
  const std::string folder = place.has_parent_path() ? place.parent_path().string() : ".";
  Target target = {.path = place.string(), .permissions = {}};

  struct stat old = {};
  if (stat(target.path.c_str(), &old) == 0) {
    // Renaming a file to the name of a device would remove the device.
    if (!S_ISREG(old.st_mode)) return CannotWrite(path, "it is not a regular file");
    if (faccessat(AT_FDCWD, target.path.c_str(), W_OK, AT_EACCESS) != 0) {
      return CannotWrite(path, ErrorText(errno));
    }
    target.permissions = old.st_mode & 07777;
  }
  if (!std::filesystem::is_directory(folder, missing)) {
    return CannotWrite(path, absl::StrCat("there is no folder ", folder));
  }
  return target;
}

// A temporary file beside the target. RenameTo gives it the target's name; the destructor removes
// it if it was not renamed.
class PartFile {
 public:
  explicit PartFile(const Target& target)
      : path_(absl::StrCat(target.path, ".", getpid(), ".part")),
        file_(open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) {
    if (file_ < 0) error_ = errno;
    if (file_ >= 0 && target.permissions && fchmod(file_, *target.permissions) != 0) error_ = errno;
  }
  ~PartFile() {
    if (file_ < 0) return;
    close(file_);
    if (!renamed_) unlink(path_.c_str());
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  // The errno of the first step that failed, 0 if none failed. After a failure no step is executed.
  int error() const { return error_; }

  void Write(std::string_view text) {
    while (error_ == 0 && !text.empty()) {
      const ssize_t written = write(file_, text.data(), text.size());
      if (written >= 0) {
        text.remove_prefix(static_cast<size_t>(written));
      } else if (errno != EINTR) {
        error_ = errno;
      }
    }
  }

  // Syncs the file before the rename, so that after a power cut the name never has a partial text.
  void RenameTo(const std::string& path) {
    if (error_ == 0 && fsync(file_) != 0) error_ = errno;
    if (error_ == 0 && rename(path_.c_str(), path.c_str()) != 0) error_ = errno;
    renamed_ = error_ == 0;
  }

 private:
  std::string path_;
  int file_;
  int error_ = 0;
  bool renamed_ = false;
};

}  // namespace

absl::Status CheckWritable(const std::string& path) {
  const absl::StatusOr<Target> target = FindTarget(path);
  if (!target.ok()) return target.status();
  const PartFile part(*target);
  return part.error() == 0 ? absl::OkStatus() : CannotWrite(path, ErrorText(part.error()));
}

absl::Status WriteWholeFile(const std::string& path, const std::string& text) {
  const absl::StatusOr<Target> target = FindTarget(path);
  if (!target.ok()) return target.status();
  PartFile part(*target);
  part.Write(text);
  part.RenameTo(target->path);
  return part.error() == 0 ? absl::OkStatus() : CannotWrite(path, ErrorText(part.error()));
}

}  // namespace ballpiston::stability
