#include "client/web/page_files.h"

#include <filesystem>

#include "absl/strings/str_cat.h"
#include "client/library/installed_files.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

// Empty if the file does not belong to the page.
std::string TypeOf(const fs::path& file) {
  static const auto* const types =
      new std::map<std::string, std::string>{{".html", "text/html; charset=utf-8"},
                                             {".js", "text/javascript; charset=utf-8"},
                                             {".css", "text/css; charset=utf-8"},
                                             {".svg", "image/svg+xml"}};
  const auto type = types->find(file.extension());
  return type == types->end() ? "" : type->second;
}

}  // namespace

absl::StatusOr<std::map<std::string, PageFile>> ReadPageFiles() {
  const fs::path folder = InstalledFolder("web");
  std::map<std::string, PageFile> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string type = TypeOf(entry);
    if (!type.empty()) files[entry.path().filename()] = {type, Contents(entry)};
  }
  if (files.contains("index.html")) return files;
  return absl::FailedPreconditionError(
      absl::StrCat("the page is not installed in ", folder.string()));
}

}  // namespace ballpiston::client
