// Reading the files that the server's security rests on.
//
// An error names the flag, the file and what is wrong with it, never its content.
#ifndef BALLPISTON_SERVER_SECURITY_PRIVATE_FILE_H_
#define BALLPISTON_SERVER_SECURITY_PRIVATE_FILE_H_

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

// More than any list of credentials or chain of certificates.
inline constexpr size_t kMaxSecurityFile = size_t{1} << 20;

// A regular file (or a link to one) of at most kMaxSecurityFile bytes. INVALID_ARGUMENT if it is
// not, or cannot be read.
absl::StatusOr<std::string> ReadPublicFile(const NamedFile& file);

// The same for a file with a secret or with access rights. It has to belong to the server's user or
// to root, with mode 0600, or 0640 at most.
absl::StatusOr<std::string> ReadPrivateFile(const NamedFile& file);

// Whether a file with this status is kept from others: its owner is `user` or root, nobody else
// writes to it, and at most its group reads it (a key is often root's, readable by a group).
absl::Status CheckKeptPrivate(const NamedFile& file, const struct stat& status, uid_t user);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_PRIVATE_FILE_H_
