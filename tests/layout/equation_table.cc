#include "tests/layout/equation_table.h"

#include <cstddef>
#include <regex>
#include <sstream>

namespace ballpiston {
namespace {

constexpr std::string_view kBegin = "<!-- equations:begin -->";
constexpr std::string_view kEnd = "<!-- equations:end -->";
constexpr std::string_view kFolder = "core/closed_form/";
constexpr std::string_view kNoFunction = "No function:";

std::string BetweenMarks(std::string_view markdown) {
  const size_t begin = markdown.find(kBegin), end = markdown.find(kEnd);
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) return "";
  return std::string(markdown.substr(begin + kBegin.size(), end - begin - kBegin.size()));
}

bool HasWord(const std::string& text, const std::string& word) {
  return std::regex_search(text, std::regex("\\b" + word + "\\b"));
}

}  // namespace

std::vector<EquationRow> EquationRows(std::string_view markdown) {
  static const std::regex kRow(R"(\| `(\w+)` \| [^|]+ \| ([^|]+) \|)");
  std::vector<EquationRow> rows;
  std::istringstream lines(BetweenMarks(markdown));
  std::string line;
  for (std::smatch found; std::getline(lines, line);) {
    if (std::regex_match(line, found, kRow)) rows.push_back({found[1], found[2]});
  }
  return rows;
}

std::vector<CodeReference> ReferencesIn(std::string_view text) {
  static const std::regex kReference(R"(`([\w/.]+): (\w+)`)");
  const std::string copy(text);
  std::vector<CodeReference> references;
  for (std::sregex_iterator found(copy.begin(), copy.end(), kReference), end; found != end;
       ++found) {
    std::string file = (*found)[1];
    if (file.find('/') == std::string::npos) file.insert(0, kFolder);
    references.push_back({file, (*found)[2]});
  }
  return references;
}

std::vector<std::string> WrongRows(
    const std::vector<EquationRow>& rows,
    const std::function<std::string(const std::string& path)>& contents) {
  std::vector<std::string> wrong;
  for (const EquationRow& row : rows) {
    const std::vector<CodeReference> references = ReferencesIn(row.where);
    if (references.empty() && !row.where.starts_with(kNoFunction)) {
      wrong.push_back(row.label + ": names no function");
    }
    for (const CodeReference& reference : references) {
      if (HasWord(contents(reference.file), reference.name)) continue;
      wrong.push_back(row.label + ": there is no " + reference.name + " in " + reference.file);
    }
  }
  return wrong;
}

}  // namespace ballpiston
