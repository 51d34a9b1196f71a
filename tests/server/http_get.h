// One request to an HTTP server on the loopback, byte by byte as the test wants it.
#pragma once

#include <string>

namespace ballpiston::server {

// A TCP connection; closed when the object ends.
class Connection {
 public:
  explicit Connection(const std::string& address);  // 127.0.0.1:PORT
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void Send(const std::string& bytes);
  std::string ReadToTheEnd();

 private:
  int descriptor_;
};

// The whole answer to GET `path`, headers included. Asks again if the server has given up waiting
// for the request, which on a busy machine may be sent late.
std::string HttpGet(const std::string& address, const std::string& path);

}  // namespace ballpiston::server
