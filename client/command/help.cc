// ballpiston help: prints the pages of verbs, or writes them to files.
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/command/reference.h"
#include "client/command/suggestion.h"
#include "client/command/verbs.h"

namespace ballpiston::client {
namespace {

namespace fs = std::filesystem;

// The verb that the words name; null, for the program's page, if there are no words.
absl::StatusOr<const Verb*> VerbNamed(const std::vector<std::string>& words) {
  const std::string name = absl::StrJoin(words, " ");
  if (name.empty()) return nullptr;
  std::vector<std::string> names;
  for (const Verb& verb : Verbs()) {
    if (verb.name == name) return &verb;
    names.push_back(verb.name);
  }
  return absl::InvalidArgumentError(NotOneOf(name, names));
}

absl::Status WriteManPage(const std::string& folder, const Verb* verb) {
  const fs::path path = fs::path(folder) / (PageName(verb) + ".1");
  std::ofstream file(path);
  file << ManPage(verb);
  file.close();
  if (file) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("--out: cannot write ", path.string(), ": ", std::strerror(errno)));
}

absl::Status WriteManPages(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  absl::Status status = WriteManPage(folder, nullptr);
  for (const Verb& verb : Verbs()) status.Update(WriteManPage(folder, &verb));
  return status;
}

}  // namespace

VerbResult Help(const Options& options, Terminal& terminal) {
  const absl::StatusOr<const Verb*> verb = VerbNamed(options.words);
  if (!verb.ok()) {
    const std::string page = options.words.size() == 1 ? GroupPage(options.words[0]) : "";
    if (page.empty()) return verb.status();
    terminal.out << page;
    return ExitCode::kDone;
  }
  if (!options.out.empty()) {
    if (absl::Status written = WriteManPages(options.out); !written.ok()) return written;
  } else if (options.page == PageFormat::kMarkdown) {
    terminal.out << MarkdownReference();
  } else {
    const bool is_man = options.page == PageFormat::kMan;
    terminal.out << (is_man ? ManPage(*verb) : options.all ? TextPage(*verb) : ShortPage(*verb));
  }
  return ExitCode::kDone;
}

}  // namespace ballpiston::client
