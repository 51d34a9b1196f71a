// Limits for clients that are not authenticated yet: streams, memory, threads, time.
#include "tests/server/http_get.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

// A client, HTTP/2 by hand, whose requests never end: each announces more than it sends.
class EndlessRequests {
 public:
  explicit EndlessRequests(const std::string& address) : connection_(address) {
    connection_.Send("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + Frame(kSettings, 0, 0, ""));
  }

  // Begins a request and sends `bytes` of it, as fast as the server reads. False if the server
  // ended a request of this client.
  bool Send(size_t bytes) {
    const uint32_t stream = next_stream_;
    next_stream_ += 2;
    connection_.Send(Frame(kHeaders, 4, stream, Headers()));
    Send(stream, std::string("\0\0\x3f\xff\xff", 5));  // of a message of just under 4 MiB
    for (size_t sent = 0; sent < bytes && !ended_; sent += kPiece) {
      Send(stream, std::string(kPiece, 'x'));
    }
    return !ended_;
  }

  // Waits until the server ends a request, or the connection.
  bool EndsOne() {
    while (!ended_) ReadFrame();
    return ended_;
  }

 private:
  enum Type : uint8_t { kData = 0, kHeaders = 1, kReset = 3, kSettings = 4, kWindowUpdate = 8 };
  static constexpr size_t kPiece = 16'384;

  static std::string Number(uint64_t value, int bytes) {
    std::string text;
    for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(value >> (8 * i));
    return text;
  }
  static std::string Frame(Type type, uint8_t flags, uint32_t stream, const std::string& payload) {
    return Number(payload.size(), 3) + Number(type, 1) + Number(flags, 1) + Number(stream, 4) +
           payload;
  }
  static std::string Headers() {
    std::string all;
    for (const auto& [name, value] : std::vector<std::pair<std::string, std::string>>{
             {":method", "POST"},
             {":scheme", "http"},
             {":path", "/ballpiston.v1.EnsembleService/CreateEnsembleJob"},
             {":authority", "localhost"},
             {"te", "trailers"},
             {"content-type", "application/grpc"}}) {
      all += Number(0, 1) + Number(name.size(), 1) + name + Number(value.size(), 1) + value;
    }
    return all;
  }

  // Uses only the initial window of each stream.
  void Send(uint32_t stream, const std::string& data) {
    while (window_ < static_cast<int64_t>(data.size()) && !ended_) ReadFrame();
    if (ended_) return;
    window_ -= static_cast<int64_t>(data.size());
    connection_.Send(Frame(kData, 0, stream, data));
  }

  void ReadFrame() {
    const auto number = [this](size_t at, size_t bytes) {
      uint64_t value = 0;
      for (size_t i = at; i < at + bytes; ++i) value = value << 8 | static_cast<uint8_t>(read_[i]);
      return value;
    };
    if (!Await(9) || !Await(9 + number(0, 3))) return;
    const auto type = static_cast<Type>(number(3, 1));
    const uint64_t stream = number(5, 4);
    if (type == kWindowUpdate && stream == 0) window_ += static_cast<int64_t>(number(9, 4));
    if (type == kReset || type == kHeaders) ended_ = true;
    read_.erase(0, 9 + number(0, 3));
  }

  bool Await(size_t bytes) {
    while (read_.size() < bytes && !ended_) {
      const std::string some = connection_.ReadSome();
      ended_ = some.empty();
      read_ += some;
    }
    return !ended_;
  }

  Connection connection_;
  std::string read_;
  int64_t window_ = 65'535;  // of the connection
  uint32_t next_stream_ = 1;
  bool ended_ = false;
};

// Some 40 MiB without end, where 16 MiB are allowed; on one connection, that shows no credentials.
TEST(ConnectionBounds, EndlessRequestsAreEndedWhenMemoryIsUsedUp) {
  constexpr size_t kOfEach = 49'152;  // less than a stream's window at the start
  RunningServer server({.listen = "127.0.0.1:0", .limits = {.max_transfer_mib = 16}});
  EndlessRequests client(server.address());
  for (int begun = 0; begun < 900 && client.Send(kOfEach); ++begun) {
  }
  EXPECT_TRUE(client.EndsOne());
  // Other clients can connect again after a while. There is room only for moments.
  AwaitThat([&server] { return CallByName(server.channel(), kCheckHealth).ok(); });
}

TEST(ConnectionBounds, ARequestOfTheGreatestLengthFitsIntoTheSmallestMemory) {
  constexpr int64_t kLongest = 64 << 20;
  RunningServer server({.limits = {.max_message_bytes = kLongest, .max_transfer_mib = 1}});
  v1::CreateEnsembleJobRequest request;
  request.set_request_id(std::string(kLongest - 100, 'x'));
  EXPECT_THAT(server.Create(request), StatusIs(grpc::StatusCode::INVALID_ARGUMENT));
}

size_t ThreadsOfThisProcess() {
  const std::filesystem::directory_iterator all("/proc/self/task");
  return static_cast<size_t>(std::distance(begin(all), end(all)));
}

TEST(ConnectionBounds, ReflectionUsesLimitedThreadsAndOtherCallsGoOn) {
  RunningServer server;
  ASSERT_OK(CallByName(server.channel(), kReflection, kListServices));
  const size_t before = ThreadsOfThisProcess();
  std::vector<std::unique_ptr<NamedCall>> streams;
  for (int i = 0; i < 60; ++i) {
    streams.push_back(std::make_unique<NamedCall>(server.channel(), kReflection));
  }
  // The server rejects the last stream. Without the limit it would stay open.
  EXPECT_THAT(streams.back()->Finish(), StatusIs(grpc::StatusCode::RESOURCE_EXHAUSTED));
  EXPECT_LT(ThreadsOfThisProcess(), before + 50);  // the client's own may be among them
  EXPECT_OK(CallByName(server.channel(), kListJobs));
  EXPECT_OK(CallByName(server.channel(), kCheckHealth));
  streams.clear();
  AwaitThat([&server] { return CallByName(server.channel(), kReflection, kListServices).ok(); });
}

// ---- connections whose client no longer answers ----

// Part of the GOAWAY frame of HTTP/2: its type, no flags, stream 0.
const std::string kGoAway("\x7\0\0\0\0\0", 6);

// In each test one time limit is short, and the others are not reached.
TestServerOptions OnPort(const ConnectionTiming& timing) {
  return {.listen = "127.0.0.1:0", .connections = timing};
}

TEST(SilentConnection, AConnectionWithoutAHandshakeIsClosed) {
  RunningServer server(
      OnPort({.handshake = std::chrono::milliseconds(200), .ping_interval = kUnreachedLimit}));
  Connection connection(server.address());
  EXPECT_THAT(connection.ReadToTheEnd(), HasSubstr(kGoAway));
}

TEST(SilentConnection, AConnectionThatAnswersNoPingIsClosed) {
  RunningServer server(OnPort({.handshake = kUnreachedLimit,
                               .ping_interval = std::chrono::milliseconds(100),
                               .ping_timeout = std::chrono::milliseconds(100)}));
  Connection connection(server.address());
  const std::string empty_settings("\0\0\0\x4\0\0\0\0\0", 9);
  connection.Send("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + empty_settings);
  EXPECT_THAT(connection.ReadToTheEnd(), HasSubstr(std::string("\0\0\x8\x6", 4)));  // the ping
}

}  // namespace
}  // namespace ballpiston::server
