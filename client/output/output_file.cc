#include "client/output/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <mutex>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"

namespace ballpiston::client {

namespace fs = std::filesystem;

namespace {

// The hidden files that are not kept yet.
struct Unfinished {
  std::mutex mutex;
  std::set<fs::path> parts;
};

Unfinished& AllUnfinished() {
  static auto* const unfinished = new Unfinished;
  return *unfinished;
}

fs::perms UsualMode() {
  const mode_t mask = umask(0);
  umask(mask);
  return static_cast<fs::perms>(0666 & ~mask);
}

absl::Status CannotWrite(const std::string& flag, const std::string& path,
                         const std::string& reason) {
  return absl::InvalidArgumentError(absl::StrCat(flag, ": cannot write ", path, ": ", reason));
}

}  // namespace

FileStream::Buffer::Buffer(int descriptor) : descriptor_(descriptor) {
  setp(bytes_.data(), bytes_.data() + bytes_.size());
}

FileStream::Buffer::int_type FileStream::Buffer::overflow(int_type c) {
  if (sync() != 0) return traits_type::eof();
  if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
  return traits_type::not_eof(c);
}

int FileStream::Buffer::sync() {
  const char* position = pbase();
  while (error_ == 0 && position < pptr()) {
    const ssize_t written = ::write(descriptor_, position, static_cast<size_t>(pptr() - position));
    if (written >= 0) position += written;
    if (written < 0 && errno != EINTR) error_ = errno;
  }
  setp(bytes_.data(), bytes_.data() + bytes_.size());
  return error_ == 0 ? 0 : -1;
}

int FileStream::Finish() {
  flush();
  return buffer_.error();
}

absl::Status CheckNewFile(const std::string& flag, const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return CannotWrite(flag, path, "this is a folder");
  const fs::path parent = fs::path(path).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  const bool is_special = fs::exists(path, error) && !fs::is_regular_file(path, error);
  const int denied = is_special ? access(path.c_str(), W_OK) : access(folder.c_str(), W_OK | X_OK);
  return denied == 0 ? absl::OkStatus() : CannotWrite(flag, path, std::strerror(errno));
}

void RemoveUnfinishedFiles() {
  static std::once_flag once;
  std::call_once(once, [] {
    AllUnfinished().mutex.lock();
    std::error_code ignored;
    for (const fs::path& part : AllUnfinished().parts) fs::remove(part, ignored);
  });
}

NewFile::NewFile(std::string flag, std::string path)
    : flag_(std::move(flag)),
      path_(std::move(path)),
      descriptor_(Open()),
      open_error_(descriptor_ < 0 ? errno : 0),
      out_(descriptor_) {}

// A pipe or a device itself, else a new file beside the old one that nobody else has made, with the
// permissions that the complete file will have.
int NewFile::Open() {
  std::error_code error;
  const bool exists = fs::exists(path_, error);
  file_ = exists ? fs::canonical(path_, error) : fs::path(path_);
  if (exists && !fs::is_regular_file(file_, error)) {
    return open(file_.c_str(), O_WRONLY | O_CLOEXEC);
  }
  const fs::perms mode = exists ? fs::status(file_, error).permissions() : UsualMode();
  const std::string hidden = absl::StrCat(".", file_.filename().string(), ".XXXXXX");
  std::string name = (file_.parent_path() / hidden).string();
  const std::lock_guard lock(AllUnfinished().mutex);
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) return descriptor;
  part_ = name;
  AllUnfinished().parts.insert(part_);
  fchmod(descriptor, static_cast<mode_t>(mode));
  return descriptor;
}

NewFile::~NewFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (part_.empty()) return;
  const std::lock_guard lock(AllUnfinished().mutex);
  std::error_code ignored;
  fs::remove(part_, ignored);
  AllUnfinished().parts.erase(part_);
}

absl::Status NewFile::Flush() {
  if (open_error_ != 0) return CannotWrite(flag_, path_, std::strerror(open_error_));
  const int error = out_.Finish();
  if (error != 0) return CannotWrite(flag_, path_, std::strerror(error));
  if (!out_) return CannotWrite(flag_, path_, "its content could not be made");
  return absl::OkStatus();
}

absl::Status NewFile::Keep() {
  if (absl::Status written = Flush(); !written.ok()) return written;
  if (part_.empty()) return absl::OkStatus();
  // Some network file systems report a full disk only here.
  if (fsync(descriptor_) != 0) return CannotWrite(flag_, path_, std::strerror(errno));
  const std::lock_guard lock(AllUnfinished().mutex);
  std::error_code error;
  fs::rename(part_, file_, error);
  if (error) return CannotWrite(flag_, path_, error.message());
  AllUnfinished().parts.erase(part_);
  part_.clear();
  return absl::OkStatus();
}

}  // namespace ballpiston::client
