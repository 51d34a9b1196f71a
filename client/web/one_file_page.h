// A page with its style sheets, scripts and data in one file. The file needs neither a server nor a
// network.
#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/web/page_files.h"

namespace ballpiston::client {

// Replaces each <link rel="stylesheet" href="NAME"> and <script src="NAME" defer></script> by the
// content of the file NAME, and <!-- data --> by the JSON, as <script type="application/json"
// id="data">. FAILED_PRECONDITION if a file is not installed.
absl::StatusOr<std::string> OneFilePage(const std::map<std::string, PageFile>& files,
                                        const std::string& name, absl::string_view json);

}  // namespace ballpiston::client
