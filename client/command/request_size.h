// Whether a request is small enough to be sent.
//
// A server accepts messages of up to 4 MiB. What is larger is refused by the transport, in its own
// words and without naming the field; so it is refused here.
#ifndef BALLPISTON_CLIENT_COMMAND_REQUEST_SIZE_H_
#define BALLPISTON_CLIENT_COMMAND_REQUEST_SIZE_H_

#include <google/protobuf/message.h>

#include <cstddef>
#include <string>

#include "absl/status/status.h"

namespace ballpiston::client {

// What is sent along with a specification (the request's id) has room in the last KiB.
inline constexpr size_t kMaxRequestBytes = (4 << 20) - 1024;

// INVALID_ARGUMENT with one line for each list of more than kMaxListLength (number_list.h) values,
// else for the whole if it is too large: path, size, what is permitted. `path` is the message's
// own, empty for a whole request.
absl::Status CheckSize(const google::protobuf::Message& message, const std::string& path);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_REQUEST_SIZE_H_
