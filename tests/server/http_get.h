// One request to an HTTP server on the loopback, byte by byte as the test wants it.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <cerrno>

#include "tests/support/preamble.h"

namespace ballpiston::server {

// A TCP connection; closed when the object ends.
class Connection {
 public:
  explicit Connection(const std::string& address)  // 127.0.0.1:PORT
      : descriptor_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const size_t colon = address.rfind(':');
    sockaddr_in to = {};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<uint16_t>(std::stoi(address.substr(colon + 1))));
    const timeval patience = {.tv_sec = std::chrono::seconds(kPatience).count(), .tv_usec = 0};
    setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    inet_pton(AF_INET, address.substr(0, colon).c_str(), &to.sin_addr);
    EXPECT_EQ(connect(descriptor_, reinterpret_cast<const sockaddr*>(&to), sizeof(to)), 0);
  }
  ~Connection() { close(descriptor_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void Send(const std::string& bytes) {
    const ssize_t sent = send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    EXPECT_EQ(sent, static_cast<ssize_t>(bytes.size()));
  }

  std::string ReadToTheEnd() {
    std::string all;
    char buffer[4096];
    ssize_t n = 0;
    while ((n = recv(descriptor_, buffer, sizeof(buffer), 0)) > 0) {
      all.append(buffer, static_cast<size_t>(n));
    }
    if (n < 0 && errno == EAGAIN) throw std::runtime_error("no byte has come for 15 minutes");
    return all;
  }

 private:
  const int descriptor_;
};

// The whole answer to GET `path`, headers included. Asks again if the server has given up waiting
// for the request, which on a busy machine may be sent late.
inline std::string HttpGet(const std::string& address, const std::string& path) {
  const std::string request =
      "GET " + path + " HTTP/1.1\r\nHost: " + address + "\r\nConnection: close\r\n\r\n";
  for (int attempt = 0; attempt < 20; ++attempt) {
    Connection connection(address);
    connection.Send(request);
    const std::string answer = connection.ReadToTheEnd();
    if (!answer.empty() && !answer.starts_with("HTTP/1.1 408")) return answer;
  }
  ADD_FAILURE() << address << " does not answer GET " << path;
  return "";
}

}  // namespace ballpiston::server
