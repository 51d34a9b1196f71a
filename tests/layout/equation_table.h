// The table of the paper's equations in core/closed_form/README.md: which file and function
// computes each.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace ballpiston {

// Text in backquotes of the form `file: name`.
struct CodeReference {
  std::string file;  // its path in the project; one without a folder lies in core/closed_form
  std::string name;

  friend bool operator==(const CodeReference&, const CodeReference&) = default;
};

struct EquationRow {
  std::string label;
  std::string where;  // the last column
};

// The rows between the marks `equations:begin` and `equations:end`, without the header.
std::vector<EquationRow> EquationRows(std::string_view markdown);

std::vector<CodeReference> ReferencesIn(std::string_view text);

// One sentence for each row that has no reference and does not begin with "No function:", and for
// each name that is not a word of its file. `contents` gives the text of a file, empty if there is
// no such file.
std::vector<std::string> WrongRows(
    const std::vector<EquationRow>& rows,
    const std::function<std::string(const std::string& path)>& contents);

}  // namespace ballpiston
