// A shared folder in memory, for tests of the server and its workers. It can fail. Copies are the
// same folder. Not thread-safe.
#pragma once

#include "server/worker/shared_files.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

class FakeFiles : public SharedFiles {
  struct File {
    std::string bytes;
    absl::Time time;
  };
  struct Folder {
    std::map<std::string, File> files;
    absl::Time now = absl::UnixEpoch();
    std::function<absl::Status(const char* operation, const std::string& path)> before = nullptr;
  };
  const std::shared_ptr<Folder> folder_;

 public:
  FakeFiles() : folder_(std::make_shared<Folder>()) {}
  FakeFiles(const FakeFiles& other) : folder_(other.folder_) {}

  // By path. A test may change it as another machine would.
  std::map<std::string, File>& files = folder_->files;
  absl::Time& now = folder_->now;  // the folder's clock
  // Called before each operation; if its result is not OK, the operation fails with it.
  std::function<absl::Status(const char* operation, const std::string& path)>& before =
      folder_->before;
  // Sets `before` for the operations of this name only.
  void Before(const std::string& operation, const std::function<absl::Status()>& call) {
    before = [operation, call](const std::string& begun, const std::string&) {
      return begun == operation ? call() : absl::OkStatus();
    };
  }

  absl::StatusOr<std::vector<std::string>> List(const std::string& subfolder) override {
    const absl::Status begun = Begin("list", subfolder);
    if (!begun.ok()) return begun;
    std::vector<std::string> names;
    const std::string prefix = subfolder + "/";
    for (const auto& [path, file] : files) {
      if (!path.starts_with(prefix)) continue;
      const std::string name = path.substr(prefix.size());
      if (!name.starts_with('.')) names.push_back(name);
    }
    return names;
  }

  absl::StatusOr<FileStamp> Create(const std::string& path, absl::string_view bytes) override {
    const absl::Status begun = Begin("create", path);
    if (!begun.ok()) return begun;
    if (files.contains(path)) return absl::UnavailableError(path + ": file exists");
    files[path] = {std::string(bytes), Tick()};
    return FileStamp{files[path].time, bytes.size()};
  }

  absl::StatusOr<std::string> Read(const std::string& path, size_t offset) override {
    const absl::Status begun = Find("read", path);
    if (!begun.ok()) return begun;
    const std::string& bytes = files[path].bytes;
    return bytes.substr(std::min(offset, bytes.size()));
  }

  absl::Status Append(const std::string& path, absl::string_view bytes) override {
    absl::Status begun = Find("append", path);
    if (begun.ok()) files[path] = {absl::StrCat(files[path].bytes, bytes), Tick()};
    return begun;
  }

  absl::Status Move(const std::string& from, const std::string& to) override {
    absl::Status begun = Find("move", from);
    if (begun.ok()) files[to] = files.extract(from).mapped();
    return begun;
  }

  absl::Status Touch(const std::string& path) override {
    absl::Status begun = Find("touch", path);
    if (begun.ok()) files[path].time = Tick();
    return begun;
  }

  absl::StatusOr<FileStamp> Stamp(const std::string& path) override {
    const absl::Status begun = Find("stamp", path);
    if (!begun.ok()) return begun;
    return FileStamp{files[path].time, files[path].bytes.size()};
  }

  absl::Status Remove(const std::string& path) override {
    absl::Status begun = Find("remove", path);
    if (begun.ok()) files.erase(path);
    return begun;
  }

 private:
  absl::Time Tick() { return now += absl::Nanoseconds(1); }

  absl::Status Begin(const char* operation, const std::string& path) {
    return before ? before(operation, path) : absl::OkStatus();
  }

  absl::Status Find(const char* operation, const std::string& path) {
    absl::Status begun = Begin(operation, path);
    if (begun.ok() && !files.contains(path)) return absl::NotFoundError(path);
    return begun;
  }
};

}  // namespace ballpiston::server
