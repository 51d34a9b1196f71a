// Reads the files with credentials, keys and certificates.
//
// An error names the flag, the file and the problem, and never quotes the file.
#pragma once

#include <sys/stat.h>

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston::server {

struct NamedFile {
  std::string flag;  // the flag with this path as its value; without the leading dashes
  std::string path;

  std::string Text() const { return "--" + flag + "=" + path; }  // for messages
};

// INVALID_ARGUMENT that names the flag and the file.
absl::Status Unusable(const NamedFile& file, absl::string_view why);

// Larger than every list of credentials and every chain of certificates.
inline constexpr size_t kMaxSecurityFile = size_t{1} << 20;

// A regular file (or a link to one) of at most kMaxSecurityFile bytes. INVALID_ARGUMENT if the file
// is something else, or cannot be read.
absl::StatusOr<std::string> ReadPublicFile(const NamedFile& file);

// The same for a file with a secret or with access rights. The file must belong to the server's
// user or to root, and have at most mode 0640.
absl::StatusOr<std::string> ReadPrivateFile(const NamedFile& file);

// Whether a file with this status is private: its owner is `user` or root, only the owner can write
// it, and only the owner and the group can read it (a key often belongs to root and is readable by
// a group).
absl::Status CheckKeptPrivate(const NamedFile& file, const struct stat& status, uid_t user);

}  // namespace ballpiston::server
