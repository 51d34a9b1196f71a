#include "client/output/page_files.h"

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "client/library/child_process.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

// Empty if the file cannot be read.
std::string Contents(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

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

absl::StatusOr<std::string> ContentOf(const PageFiles& files, const std::string& name) {
  const auto file = files.find(name);
  if (file != files.end()) return file->second.content;
  return absl::FailedPreconditionError(absl::StrCat("the page's file ", name, " is not installed"));
}

// The page with the contents of the files that it refers to.
absl::StatusOr<std::string> WithFilesInside(const PageFiles& files, const std::string& page) {
  static const std::regex reference(
      "<link rel=\"stylesheet\" href=\"(.*?)\">|<script src=\"(.*?)\" defer></script>");
  std::string result;
  auto rest = page.begin();
  for (std::smatch found; std::regex_search(rest, page.end(), found, reference);) {
    const bool is_style = found[1].matched;
    const auto content = ContentOf(files, found[is_style ? 1 : 2]);
    if (!content.ok()) return content.status();
    absl::StrAppend(&result, std::string(rest, found[0].first),
                    is_style ? "<style>\n" : "<script>\n", *content,
                    is_style ? "</style>" : "</script>");
    rest = found[0].second;
  }
  return result.append(rest, page.end());
}

}  // namespace

absl::StatusOr<PageFiles> ReadPageFiles() {
  const fs::path program_folder = fs::path(ProgramBeside("")).parent_path();
  const fs::path folder = program_folder.parent_path() / "share/ballpiston/web";
  PageFiles files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string type = TypeOf(entry);
    if (!type.empty()) files[entry.path().filename()] = {type, Contents(entry)};
  }
  if (files.contains("index.html")) return files;
  return absl::FailedPreconditionError(
      absl::StrCat("the page is not installed in ", folder.string()));
}

absl::StatusOr<std::string> OneFilePage(const PageFiles& files, const std::string& name,
                                        absl::string_view json) {
  absl::StatusOr<std::string> page = ContentOf(files, name);
  if (page.ok()) page = WithFilesInside(files, *page);
  if (!page.ok()) return page;
  // Without "<" the JSON cannot contain the tag that ends the script.
  const std::string safe = absl::StrReplaceAll(json, {{"<", "\\u003c"}});
  return absl::StrReplaceAll(
      *page, {{"<!-- data -->",
               absl::StrCat("<script type=\"application/json\" id=\"data\">", safe, "</script>")}});
}

}  // namespace ballpiston::client
