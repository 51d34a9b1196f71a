#include "client/command/hint.h"

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "client/library/error_text.h"

namespace ballpiston::client {

absl::Status WithHint(const absl::Status& status, absl::string_view hint) {
  absl::Status with_hint(status.code(), absl::StrCat(status.message(), "\n", hint));
  status.ForEachPayload([&](absl::string_view type, const absl::Cord& payload) {
    with_hint.SetPayload(type, payload);
  });
  return with_hint;
}

absl::Status HintIfExpired(const absl::Status& status, const Connection& connection,
                           const std::string& job) {
  if (ErrorReason(status) != "RESULTS_EXPIRED") return status;
  return WithHint(status, absl::StrCat("To compute them again: ballpiston submit --again ", job,
                                       connection.flags));
}

}  // namespace ballpiston::client
