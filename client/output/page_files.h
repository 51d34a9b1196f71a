// The files of the page, in share/ballpiston/web beside this program's folder.
#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::client {

struct PageFile {
  std::string type;  // for Content-Type
  std::string content;
};

using PageFiles = std::map<std::string, PageFile>;  // by name, for instance index.html

// FAILED_PRECONDITION if the page is not installed.
absl::StatusOr<PageFiles> ReadPageFiles();

// The page with its style sheets, scripts and data in one text, which needs neither a server nor a
// network. Replaces each <link rel="stylesheet" href="NAME"> and <script src="NAME" defer></script>
// by the content of the file NAME, and <!-- data --> by the JSON, as
// <script type="application/json" id="data">. FAILED_PRECONDITION if a file is not installed.
absl::StatusOr<std::string> OneFilePage(const PageFiles& files, const std::string& name,
                                        absl::string_view json);

}  // namespace ballpiston::client
