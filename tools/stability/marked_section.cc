#include "tools/stability/marked_section.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "tools/stability/output_file.h"

namespace ballpiston::stability {
namespace {

struct MarkedFile {
  std::string text;
  size_t begin;  // after the line of the first marker
  size_t end;    // before the second marker
};

absl::StatusOr<MarkedFile> Read(const std::string& path, const std::string& name) {
  std::error_code ignored;
  std::ifstream in(path);
  if (!in || !std::filesystem::is_regular_file(path, ignored)) {
    return absl::NotFoundError(absl::StrCat("cannot read ", path));
  }
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::string begin = absl::StrCat("<!-- ", name, ":begin -->");
  const std::string end = absl::StrCat("<!-- ", name, ":end -->");
  const size_t first = text.find(begin + "\n");
  const size_t last = first == std::string::npos ? first : text.find(end + "\n", first);
  if (last == std::string::npos) {
    return absl::NotFoundError(absl::StrCat(path, " lacks the lines ", begin, " and ", end));
  }
  return MarkedFile{.text = std::move(text), .begin = first + begin.size() + 1, .end = last};
}

}  // namespace

absl::Status CheckMarkedSection(const std::string& path, const std::string& name) {
  const absl::StatusOr<MarkedFile> file = Read(path, name);
  return file.ok() ? CheckWritable(path) : file.status();
}

absl::Status ReplaceMarkedSection(const std::string& path, const std::string& name,
                                  const std::string& text) {
  absl::StatusOr<MarkedFile> file = Read(path, name);
  if (!file.ok()) return file.status();
  file->text.replace(file->begin, file->end - file->begin, text);
  return WriteWholeFile(path, file->text);
}

}  // namespace ballpiston::stability
