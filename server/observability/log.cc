#include "server/observability/log.h"

#include <cstdio>
#include <string>

#include "absl/strings/str_cat.h"

namespace ballpiston::server {
namespace {

void WriteLine(const std::string& line) { std::fwrite(line.data(), 1, line.size(), stderr); }

}  // namespace

void LogInfo(absl::string_view line) { WriteLine(absl::StrCat("ballpistond: ", line, "\n")); }

void LogError(absl::string_view line) {
  WriteLine(absl::StrCat("ballpistond: error: ", line, "\n"));
}

}  // namespace ballpiston::server
