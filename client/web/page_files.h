// The files of the page, in share/ballpiston/web beside this program's folder.
#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"

namespace ballpiston::client {

struct PageFile {
  std::string type;  // for Content-Type
  std::string content;
};

// The files by name, for instance index.html. FAILED_PRECONDITION if the page is not installed.
absl::StatusOr<std::map<std::string, PageFile>> ReadPageFiles();

}  // namespace ballpiston::client
