// Ids for calls that must not take effect twice.
#ifndef BALLPISTON_CLIENT_LIBRARY_REQUEST_ID_H_
#define BALLPISTON_CLIENT_LIBRARY_REQUEST_ID_H_

#include <string>

namespace ballpiston::client {

// A random UUID (version 4), from the system's source of randomness.
std::string NewRequestId();

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_LIBRARY_REQUEST_ID_H_
