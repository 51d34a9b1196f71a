// A call of any method, unary or streaming, by its name.
#ifndef BALLPISTON_TESTS_SERVER_CALL_BY_NAME_H_
#define BALLPISTON_TESTS_SERVER_CALL_BY_NAME_H_

#include <memory>
#include <string>
#include <vector>

#include "grpcpp/channel.h"
#include "grpcpp/support/status.h"

namespace ballpiston::server {

// Sends one request, `bytes` serialized, with such headers `authorization`; reads to the end. Ends
// after 20 s with DEADLINE_EXCEEDED.
grpc::Status CallByName(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                        const std::string& bytes, const std::vector<std::string>& authorization);

// One header, or none for an empty token.
std::vector<std::string> Bearer(const std::string& token);

}  // namespace ballpiston::server

#endif  // BALLPISTON_TESTS_SERVER_CALL_BY_NAME_H_
