#include "tests/stability/marked_section.h"

#include <fstream>
#include <iterator>

#include "absl/strings/str_cat.h"

namespace ballpiston::stability {

absl::Status ReplaceMarkedSection(const std::string& path, const std::string& name,
                                  const std::string& text) {
  std::ifstream in(path);
  if (!in) return absl::NotFoundError(absl::StrCat("cannot read ", path));
  std::string whole{std::istreambuf_iterator<char>(in), {}};
  in.close();
  const std::string begin = absl::StrCat("<!-- ", name, ":begin -->\n");
  const std::string end = absl::StrCat("<!-- ", name, ":end -->\n");
  const size_t first = whole.find(begin), last = whole.find(end);
  if (first == std::string::npos || last == std::string::npos || last < first) {
    return absl::NotFoundError(absl::StrCat(path, " lacks the lines ", begin, "and ", end));
  }
  const size_t inside = first + begin.size();
  whole.replace(inside, last - inside, text);
  std::ofstream out(path);
  out << whole;
  out.close();
  return out ? absl::OkStatus() : absl::InternalError(absl::StrCat("cannot write ", path));
}

}  // namespace ballpiston::stability
