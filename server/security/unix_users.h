// Which Unix user calls, at a socket that several users may open.
//
// gRPC tells a call nothing of its connection's descriptor: at a Unix socket every peer is "unix:".
// So each user has an acceptor of gRPC of their own. Its credentials are gRPC's for local
// connections, which encrypt nothing and which a client without credentials does not notice; their
// processor writes the user into what the calls of a connection know of it, the auth context. A
// client cannot write there. (AddInsecureChannelFromFd would name the descriptor to the calls. But
// a call can outlive its connection, and the descriptor is another user's then.)
//
// gRPC takes acceptors only before it starts, so there are kMostUnixUsers. An unused one costs some
// 5 KiB and 40 us.
#ifndef BALLPISTON_SERVER_SECURITY_UNIX_USERS_H_
#define BALLPISTON_SERVER_SECURITY_UNIX_USERS_H_

#include <sys/types.h>

#include <map>
#include <memory>
#include <vector>

#include "grpcpp/server_builder.h"
#include "server/observability/line_budget.h"

namespace ballpiston::server {

// Users that can connect in the life of a server.
inline constexpr size_t kMostUnixUsers = 1024;

class UnixUsers {
 public:
  // Adds the acceptors, whose server has to end before this object.
  explicit UnixUsers(grpc::ServerBuilder& builder, size_t most = kMostUnixUsers);
  ~UnixUsers();

  // Hands a connection of this user to gRPC; UnixUserOf (authenticator.h) then gives its calls the
  // user, with the role admin for the server's own user and root, submit for others. Closes it, and
  // logs why at most every ten seconds, if the system knows no name of the user, or if all
  // acceptors are other users'. One thread at a time. The first connection of a user waits for the
  // system's list of users; the user keeps that name as long as the server runs.
  void Receive(int descriptor, uid_t user);

 private:
  class Stamp;
  struct Entrance {
    std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor;
    std::shared_ptr<Stamp> stamp;
  };

  // Null, and logged, as Receive says.
  grpc::experimental::ExternalConnectionAcceptor* AcceptorOf(uid_t user);

  std::vector<Entrance> entrances_;
  std::map<uid_t, size_t> taken_;
  LineBudget refusals_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_SECURITY_UNIX_USERS_H_
