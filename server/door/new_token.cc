#include "server/door/new_token.h"

#include <fcntl.h>
#include <openssl/rand.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "server/door/access_list.h"
#include "server/sha256.h"
#include "server/store/folder_sync.h"

namespace ballpiston::server {
namespace {

constexpr int kMostDays = 36'500;

absl::Status WrongRequest(absl::string_view why) {
  return absl::InvalidArgumentError(
      absl::StrCat("--new-token: ", why, " (write PRINCIPAL:ROLE or PRINCIPAL:ROLE:DAYS)"));
}

absl::Status Failed(const NamedFile& file, const char* what) {
  return absl::PermissionDeniedError(
      absl::StrCat(file.Text(), ": cannot be ", what, ": ", std::strerror(errno)));
}

// An incomplete line would make the whole file invalid. So if the line cannot be written completely
// (the disk is full), its part is removed.
absl::Status WriteAllOrNothing(const NamedFile& file, int descriptor, const std::string& text) {
  const off_t length = lseek(descriptor, 0, SEEK_END);
  errno = ENOSPC;  // what a short write means
  if (write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
      fsync(descriptor) == 0) {
    return absl::OkStatus();
  }
  const absl::Status failed = Failed(file, "written to");
  return ftruncate(descriptor, length) == 0 ? failed : Failed(file, "restored to its old length");
}

absl::Status Append(const NamedFile& file, const std::string& line) {
  const int descriptor = open(file.path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0) return Failed(file, "opened");
  const absl::Cleanup closed = [descriptor] { close(descriptor); };
  if (flock(descriptor, LOCK_EX) != 0) return Failed(file, "locked");
  // Checked under the lock, when the file exists.
  const absl::StatusOr<std::string> text = ReadPrivateFile(file);
  if (!text.ok()) return text.status();
  const absl::StatusOr<AccessList> list = AccessList::Parse(file, *text);
  if (!list.ok()) return list.status();
  const bool unended = !text->empty() && text->back() != '\n';
  const std::string added = absl::StrCat(unended ? "\n" : "", line, "\n");
  if (text->size() + added.size() > kMaxSecurityFile) {
    return Unusable(file, absl::StrCat("would have ", text->size() + added.size(),
                                       " bytes with this token; permitted: up to ",
                                       kMaxSecurityFile, "; remove old tokens"));
  }
  const absl::Status written = WriteAllOrNothing(file, descriptor, added);
  // Flushes the folder too, so that the entry of a printed token survives a power cut.
  return written.ok() ? SyncNameOf(file.path) : written;
}

}  // namespace

// The prefix shows people and secret scanners that the text is a token of this server.
std::string RandomToken() {
  std::array<unsigned char, 32> bits;
  if (RAND_bytes(bits.data(), static_cast<int>(bits.size())) != 1) std::abort();
  std::string text;
  absl::WebSafeBase64Escape({reinterpret_cast<const char*>(bits.data()), bits.size()}, &text);
  return absl::StrCat("bp_", text);
}

absl::StatusOr<TokenRequest> ParseTokenRequest(absl::string_view text) {
  const std::vector<std::string> parts = absl::StrSplit(text, ':');
  if (parts.size() < 2 || parts.size() > 3) return WrongRequest("a part is missing or too many");
  if (const absl::Status name = CheckPrincipalName(parts[0]); !name.ok()) {
    return WrongRequest(name.message());
  }
  const absl::StatusOr<Role> role = ParseRole(parts[1]);
  if (!role.ok()) return WrongRequest(role.status().message());
  TokenRequest request{{parts[0], *role}, std::nullopt};
  if (parts.size() == 2) return request;
  int days = 0;
  if (!absl::SimpleAtoi(parts[2], &days) || days < 1 || days > kMostDays) {
    return WrongRequest(absl::StrCat("the days are not a number from 1 to ", kMostDays));
  }
  request.days = days;
  return request;
}

absl::StatusOr<std::string> IssueToken(const NamedFile& file, const TokenRequest& request,
                                       absl::Time now) {
  std::string token = RandomToken();
  AccessEntry entry{Sha256(token), request.principal};
  if (request.days) entry.expires = now + *request.days * absl::Hours(24);
  const absl::Status appended = Append(file, FormatAccessEntry(entry));
  if (!appended.ok()) return appended;
  return token;
}

}  // namespace ballpiston::server
