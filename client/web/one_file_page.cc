#include "client/web/one_file_page.h"

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"

namespace ballpiston::client {
namespace {

// The text with which a page refers to a file, and the tags around the content that replaces it.
struct Reference {
  absl::string_view before, after;
  absl::string_view begin, end;
};

constexpr Reference kReferences[] = {
    {"<link rel=\"stylesheet\" href=\"", "\">", "<style>\n", "</style>"},
    {"<script src=\"", "\" defer></script>", "<script>\n", "</script>"}};

absl::StatusOr<std::string> ContentOf(const std::map<std::string, PageFile>& files,
                                      const std::string& name) {
  const auto file = files.find(name);
  if (file != files.end()) return file->second.content;
  return absl::FailedPreconditionError(absl::StrCat("the page's file ", name, " is not installed"));
}

absl::StatusOr<std::string> WithFilesInside(const std::map<std::string, PageFile>& files,
                                            absl::string_view page, const Reference& reference) {
  std::string result;
  while (true) {
    const size_t at = page.find(reference.before);
    absl::StrAppend(&result, page.substr(0, at));
    if (at == absl::string_view::npos) return result;
    page.remove_prefix(at + reference.before.size());
    const size_t end = page.find(reference.after);
    const auto content = ContentOf(files, std::string(page.substr(0, end)));
    if (!content.ok()) return content.status();
    absl::StrAppend(&result, reference.begin, *content, reference.end);
    page.remove_prefix(end + reference.after.size());
  }
}

}  // namespace

absl::StatusOr<std::string> OneFilePage(const std::map<std::string, PageFile>& files,
                                        const std::string& name, absl::string_view json) {
  absl::StatusOr<std::string> page = ContentOf(files, name);
  for (const Reference& reference : kReferences) {
    if (page.ok()) page = WithFilesInside(files, *page, reference);
  }
  if (!page.ok()) return page;
  // Without "<" the JSON cannot contain the tag that ends the script.
  const std::string safe = absl::StrReplaceAll(json, {{"<", "\\u003c"}});
  return absl::StrReplaceAll(
      *page, {{"<!-- data -->",
               absl::StrCat("<script type=\"application/json\" id=\"data\">", safe, "</script>")}});
}

}  // namespace ballpiston::client
