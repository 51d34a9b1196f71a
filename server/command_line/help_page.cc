#include "server/command_line/help_page.h"

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace ballpiston::server {
namespace {

constexpr char kDescription[] =
    "The server of ballpiston: computes ensembles of rarely interacting billiards.";
constexpr char kUsage[] =
    "\nUsage:\n"
    "  ballpistond --listen unix:PATH | --listen 127.0.0.1:PORT [--data-dir DIR] [--workers N]\n"
    "  ballpistond --listen 0.0.0.0:PORT --tls-certificate FILE --tls-key FILE --access-file FILE\n"
    "  ballpistond --access-file FILE --new-token PRINCIPAL:ROLE[:DAYS]\n"
    "  ballpistond --data-dir DIR --check | --backup FILE\n"
    "  ballpistond --verify FILE\n\n";
constexpr char kExitCodes[] =
    "Exit codes: 0 stopped (SIGTERM, SIGINT, idle) or done; 1 the disk of the store is full or "
    "fails, retry later; 2 a wrong flag, an unsafe combination of flags, an address or data folder "
    "in use, or a store that is not sound; 4 a saved result that is not what this engine "
    "computes; 6 a data folder that is not writable, or that other "
    "users can enter and that is not the server's own.";
constexpr size_t kIndentation = 8;
constexpr size_t kWidth = 96;

// Breaks the text into lines of at most `width` characters.
std::string Wrapped(const std::string& text, size_t width) {
  std::string lines;
  size_t column = 0;
  for (const std::string& word : std::vector<std::string>(absl::StrSplit(text, ' '))) {
    const bool fits = column + 1 + word.size() <= width;
    if (column > 0) lines += fits ? ' ' : '\n';
    column = (column > 0 && fits ? column + 1 : 0) + word.size();
    lines += word;
  }
  return lines;
}

// Each flag has a line of its own, with its description below. CLI11's two columns are too narrow
// for long names and descriptions.
class HelpPage : public CLI::Formatter {
 public:
  HelpPage() { column_width(kIndentation); }

  std::string make_usage(const CLI::App*, std::string) const override { return kUsage; }
  // Without the second blank line between two groups.
  std::string make_group(std::string name, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    return Formatter::make_group(std::move(name), is_positional, std::move(options)).substr(1);
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    return option->get_items_expected_max() == 0 ? "" : absl::StrCat(" ", option->get_type_name());
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    const std::string value = option->get_default_str();
    const std::string text = value.empty() ? "" : absl::StrCat("; default: ", value);
    return Wrapped(option->get_description() + text, kWidth - kIndentation);
  }
};

}  // namespace

void SetHelpPage(CLI::App& app) {
  app.description(kDescription);
  app.footer(Wrapped(kExitCodes, kWidth));
  app.formatter(std::make_shared<HelpPage>());
}

}  // namespace ballpiston::server
