// Identifies the Unix user of each call at a socket that several users may open.
//
// gRPC does not tell a call the descriptor of its connection: at a Unix socket every peer is
// "unix:". Therefore each user has a gRPC acceptor of their own. Its credentials are those of gRPC
// for local connections: they encrypt nothing, and the client needs none. Their processor writes
// the user into the auth context, which all calls of a connection share. A client cannot write
// there. (With AddInsecureChannelFromFd a call would know the descriptor. But a call can outlive
// its connection, and then the descriptor may be another user's.)
//
// Acceptors can be added only before gRPC starts, so there are always kMostUnixUsers. An unused
// acceptor costs some 5 KiB and 40 us.
#pragma once

#include <sys/types.h>

#include <map>
#include <memory>
#include <vector>

#include "grpcpp/server_builder.h"
#include "server/observability/line_budget.h"

namespace ballpiston::server {

// The number of users who can connect before the server restarts.
inline constexpr size_t kMostUnixUsers = 1024;

class UnixUsers {
 public:
  // Adds the acceptors. This object must outlive the server.
  explicit UnixUsers(grpc::ServerBuilder& builder, size_t most = kMostUnixUsers);
  ~UnixUsers();

  // Hands a connection of this user to gRPC. UnixUserOf (authenticator.h) then gives its calls the
  // user, with the role admin for the server's own user and root, and submit for others. If the
  // system knows no name for the user, or if other users have all acceptors, closes the connection
  // and logs why, at most every ten seconds. One thread at a time. The first connection of a user
  // waits for the system's list of users; the user keeps that name as long as the server runs.
  void Receive(int descriptor, uid_t user);

 private:
  class Stamp;
  struct Entrance {
    std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor;
    std::shared_ptr<Stamp> stamp;
  };

  // Null, with a line in the log, if Receive has to close the connection.
  grpc::experimental::ExternalConnectionAcceptor* AcceptorOf(uid_t user);

  std::vector<Entrance> entrances_;
  std::map<uid_t, size_t> taken_;
  LineBudget refusals_;
};

}  // namespace ballpiston::server
