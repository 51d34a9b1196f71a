#include "server/command_line/flag_file.h"

#include <istream>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"

namespace ballpiston::server {
namespace {

// CLI11's own reader takes [::1]:50051 for the beginning of a list, cuts "a#b" at the #, and
// ignores a key's second value.
class FlagFile : public CLI::Config {
 public:
  explicit FlagFile(const CLI::App& app) : app_(app) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::vector<CLI::ConfigItem> items;
    std::set<const CLI::Option*> given;
    int number = 0;
    for (std::string line; std::getline(input, line);) {
      ++number;
      absl::StripAsciiWhitespace(&line);
      if (line.empty() || line.front() == '#') continue;
      CLI::ConfigItem item = ItemOf(line, number);
      if (!given.insert(app_.get_option("--" + item.name)).second) {
        throw Error(number, absl::StrCat(item.name, " is given twice"));
      }
      items.push_back(std::move(item));
    }
    return items;
  }

  std::string to_config(const CLI::App*, bool, bool, std::string) const override { return ""; }

 private:
  CLI::ConfigItem ItemOf(const std::string& line, int number) const {
    const std::vector<std::string> parts = absl::StrSplit(line, absl::MaxSplits('=', 1));
    CLI::ConfigItem item;
    item.name = std::string(absl::StripAsciiWhitespace(parts.front()));
    const CLI::Option* flag = app_.get_option_no_throw("--" + item.name);
    if (flag == nullptr) throw Error(number, NoSuchFlag(app_, item.name, item.name));
    if (!flag->get_configurable()) {
      throw Error(number, item.name + " is permitted on the command line only");
    }
    const auto value = parts.size() == 2 ? ValueOf(parts[1]) : std::nullopt;
    if (!value) throw Error(number, absl::StrCat("write ", item.name, " = \"VALUE\""));
    item.inputs = {*value};
    return item;
  }

  // VALUE or "VALUE", then an optional comment.
  static std::optional<std::string> ValueOf(const std::string& text) {
    const std::string value(absl::StripAsciiWhitespace(text));
    if (!absl::StartsWith(value, "\"")) {
      return std::string(absl::StripAsciiWhitespace(value.substr(0, value.find('#'))));
    }
    const size_t end = value.find('"', 1);
    if (end == std::string::npos) return std::nullopt;
    const std::string rest(absl::StripAsciiWhitespace(value.substr(end + 1)));
    if (!rest.empty() && rest.front() != '#') return std::nullopt;
    return value.substr(1, end - 1);
  }

  CLI::ConfigError Error(int line, const std::string& what) const {
    const auto path = app_.get_config_ptr()->as<std::string>();
    return CLI::ConfigError(absl::StrCat("--config=", path, ", line ", line, ": ", what));
  }

  const CLI::App& app_;
};

}  // namespace

std::string NoSuchFlag(const CLI::App& app, const std::string& flag, const std::string& written) {
  const std::string dashed = "--" + absl::StrReplaceAll(flag, {{"_", "-"}});
  const bool is_known = app.get_option_no_throw(dashed) != nullptr;
  return absl::StrCat(written, " is not a flag; ",
                      is_known ? absl::StrCat("it is spelled ", dashed) : "--help lists them");
}

void AddFlagFile(CLI::App& app) {
  app.config_formatter(std::make_shared<FlagFile>(app));
  app.set_config("--config", "",
                 "file of flags, read at the start: a line each, FLAG = VALUE, without the dashes. "
                 "A flag of the command line takes precedence")
      ->type_name("FILE");
}

}  // namespace ballpiston::server
