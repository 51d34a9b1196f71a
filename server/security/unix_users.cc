#include "server/security/unix_users.h"

#include <unistd.h>

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "grpcpp/security/auth_metadata_processor.h"
#include "grpcpp/security/server_credentials.h"
#include "server/mutex.h"
#include "server/observability/log.h"
#include "server/security/authenticator.h"
#include "server/security/peer_user.h"

namespace ballpiston::server {
namespace {

// A user without a name is not accepted. It could be one of the thousands that a rootless container
// has, or any user while the directory service does not answer. With a number in place of the name,
// such a user would be another principal once the service answers again. Only the server's own user
// and root need no name.
std::optional<Principal> PrincipalOf(uid_t user) {
  const bool is_admin = MayConnect(user, OwnUserAndRoot());
  std::optional<std::string> name = UserName(user);
  if (!name && is_admin) return LocalPrincipal();
  if (!name) return std::nullopt;
  return Principal{*std::move(name), is_admin ? Role::kAdmin : Role::kSubmit};
}

}  // namespace

// All calls of a connection share its auth context. It is written once, before the first call runs,
// and only read afterwards.
class UnixUsers::Stamp : public grpc::AuthMetadataProcessor {
 public:
  void Set(Principal user) {
    const MutexLock lock(mutex_);
    user_ = std::move(user);
  }

  bool IsBlocking() const override { return false; }
  grpc::Status Process(const InputMetadata&, grpc::AuthContext* context, OutputMetadata*,
                       OutputMetadata*) override {
    const MutexLock lock(mutex_);
    if (!UnixUserOf(*context)) SetUnixUser(*context, user_);
    return grpc::Status::OK;
  }

 private:
  Mutex mutex_;
  Principal user_ ABSL_GUARDED_BY(mutex_);
};

UnixUsers::UnixUsers(grpc::ServerBuilder& builder, size_t most)
    : refusals_(1, std::chrono::seconds(10)) {
  using Builder = grpc::ServerBuilder::experimental_type;
  for (size_t i = 0; i < most; ++i) {
    auto stamp = std::make_shared<Stamp>();
    const auto credentials = grpc::experimental::LocalServerCredentials(UDS);
    credentials->SetAuthMetadataProcessor(stamp);
    entrances_.push_back({builder.experimental().AddExternalConnectionAcceptor(
                              Builder::ExternalConnectionType::FROM_FD, credentials),
                          std::move(stamp)});
  }
}

UnixUsers::~UnixUsers() = default;

void UnixUsers::Receive(int descriptor, uid_t user) {
  auto* const acceptor = AcceptorOf(user);
  if (acceptor == nullptr) {
    close(descriptor);
    return;
  }
  grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
  connection.fd = descriptor;
  acceptor->HandleNewConnection(&connection);
}

grpc::experimental::ExternalConnectionAcceptor* UnixUsers::AcceptorOf(uid_t user) {
  if (const auto found = taken_.find(user); found != taken_.end()) {
    return entrances_[found->second].acceptor.get();
  }
  const bool is_full = taken_.size() == entrances_.size();
  std::optional<Principal> principal = is_full ? std::nullopt : PrincipalOf(user);
  if (!principal) {
    const char* const why = is_full ? "too many different users have connected; restart the server"
                                    : "the system has no name for this user";
    if (refusals_.Take(std::chrono::steady_clock::now())) {
      LogError(absl::StrCat("connection of user ", user, " closed: ", why));
    }
    return nullptr;
  }
  const Entrance& entrance = entrances_[taken_.size()];
  taken_.emplace(user, taken_.size());
  entrance.stamp->Set(*std::move(principal));
  return entrance.acceptor.get();
}

}  // namespace ballpiston::server
