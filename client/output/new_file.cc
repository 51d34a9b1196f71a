#include "client/output/new_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"

namespace ballpiston::client {

namespace fs = std::filesystem;

namespace {

absl::Status CannotWrite(const std::string& flag, const std::string& path,
                         const std::string& reason) {
  return absl::InvalidArgumentError(absl::StrCat(flag, ": cannot write ", path, ": ", reason));
}

}  // namespace

absl::Status CheckNewFile(const std::string& flag, const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  std::error_code error;
  if (fs::is_directory(path, error)) return CannotWrite(flag, path, "this is a folder");
  if (access(parent.empty() ? "." : parent.c_str(), W_OK | X_OK) == 0) return absl::OkStatus();
  return CannotWrite(flag, path, std::strerror(errno));
}

NewFile::NewFile(std::string flag, std::string path)
    : flag_(std::move(flag)), path_(std::move(path)) {
  std::error_code error;
  const bool exists = fs::exists(path_, error);
  file_ = exists ? fs::canonical(path_, error) : fs::path(path_);
  const bool is_special = exists && !fs::is_regular_file(file_, error);
  const std::string hidden = absl::StrCat(".", file_.filename().string(), ".", getpid());
  part_ = is_special ? file_ : file_.parent_path() / hidden;
  errno = 0;
  out_.open(part_, std::ios::binary);
  open_error_ = out_ ? 0 : errno;
}

NewFile::~NewFile() {
  std::error_code ignored;
  if (part_ != file_) fs::remove(part_, ignored);
}

absl::Status NewFile::Keep() {
  if (open_error_ != 0) return CannotWrite(flag_, path_, std::strerror(open_error_));
  errno = 0;
  out_.close();
  if (!out_) {
    return CannotWrite(flag_, path_, errno != 0 ? std::strerror(errno) : "the disk may be full");
  }
  std::error_code error;
  if (part_ != file_) fs::rename(part_, file_, error);
  return error ? CannotWrite(flag_, path_, error.message()) : absl::OkStatus();
}

}  // namespace ballpiston::client
