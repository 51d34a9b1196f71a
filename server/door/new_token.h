// Makes a token of 256 random bits. It is printed once; the access file keeps only its hash.
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "server/door/principal.h"
#include "server/door/private_file.h"

namespace ballpiston::server {

struct TokenRequest {
  Principal principal;
  std::optional<int> days;  // until it expires
};

// Parses PRINCIPAL:ROLE[:DAYS], where DAYS is 1 to 36500. INVALID_ARGUMENT names --new-token and
// the permitted values.
absl::StatusOr<TokenRequest> ParseTokenRequest(absl::string_view text);

// Appends the token's entry to the access file and returns the token when the entry is on disk.
// Creates the file (mode 0600) if it does not exist. Rejects a file that is not an access file or
// that other users can read. On an error, also if the disk is full, the file is unchanged, or
// empty if it did not exist. Concurrent calls wait for each other.
absl::StatusOr<std::string> IssueToken(const NamedFile& file, const TokenRequest& request,
                                       absl::Time now);

// bp_ and 256 random bits. Ends the process if the system has no random numbers.
std::string RandomToken();

}  // namespace ballpiston::server
