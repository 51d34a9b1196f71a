// Addresses, as client and server parse them: the client can call every address at which the server
// can listen.
#include "client/library/server_address.h"

#include "absl/strings/match.h"
#include "server/door/listen_address.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

void CheckListening(const std::string& text) {
  const absl::StatusOr<server::ListenAddress> address = server::ParseListenAddress(text);
  if (!address.ok()) {
    Require(absl::IsInvalidArgument(address.status()), "what is wrong is the argument");
    return Require(absl::StrContains(address.status().message(), "--listen"), "the flag is named");
  }
  const auto again = server::ParseListenAddress(address->Text());
  Require(again.ok() && again->Text() == address->Text(), "an address is its own");
  const bool any_port = address->socket_path.empty() && address->port == 0;
  if (any_port || address->socket_path.size() > client::kMaxSocketPath) return;
  Require(client::GrpcTarget(address->Text()).ok(), "the client can call the server");
}

void CheckServerAddress(const std::string& text) {
  if (text.find('\0') != std::string::npos) return;  // a program's arguments cannot contain it
  const absl::StatusOr<std::string> target = client::GrpcTarget(text);
  if (target.ok()) {
    Require(absl::StartsWith(*target, "unix:") || absl::StartsWith(*target, "dns:///"),
            "a target has a scheme");
  } else {
    Require(absl::IsInvalidArgument(target.status()), "what is wrong is the argument");
  }
  CheckListening(text);
}

const Registration kServerAddress({.name = "server_address", .check = CheckServerAddress});

}  // namespace
}  // namespace ballpiston::fuzz
