// ballpiston-web has the main function and the verbs of ballpiston, but its verb `web` is this HTTP
// server for local connections: the files of the page, and a gateway that forwards calls in the
// Connect protocol to ballpistond.
//
//   GET  /                                 the page
//   POST /ballpiston.v1.SERVICE/METHOD     a call, with the token
//
// Other programs on this machine, and web pages of other sites in the user's browser, can reach the
// same port. Headers of a request are checked before its body is read:
//
//   Host           must be this page's address. This rejects a foreign name that resolves to this
//                  machine (DNS rebinding).
//   Origin         must be this page's, if the browser sends it
//   Authorization  must be Bearer TOKEN in every call to the server. The page's files contain no
//                  secrets and need no token.
//   Content-Length must be there in every call, without Content-Encoding and Transfer-Encoding, so
//                  that the size of the body is known
//
// Each connection uses one of kMostConnections threads. A stream beyond kMostStreams is refused, so
// that threads are left for other calls. If a stream's reader disconnects, the call ends at the
// next message. A watch sends heartbeats, so that there is always a next message.
#include <httplib.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "client/command/connection.h"
#include "client/library/quoted.h"
#include "client/library/request_id.h"
#include "client/output/page_files.h"
#include "client/web/connect_protocol.h"

namespace ballpiston::client {
namespace {

constexpr char kLoopback[] = "127.0.0.1";
constexpr int kMostConnections = 32;
constexpr int kMostStreams = 24;
constexpr size_t kMostCallsPerConnection = 1000;
// JSON is two to three times longer than gRPC's message, of which the server permits 4 MiB.
constexpr size_t kMostRequestBytes = 16 << 20;
// The longest time that a reader of a stream may pause.
constexpr std::chrono::hours kPatience{1};

using httplib::Request;
using httplib::Response;

// The page loads nothing from other sites, and no other page may show it in a frame.
const httplib::Headers& SafeHeaders() {
  static const auto* const headers = new httplib::Headers{
      {"Content-Security-Policy",
       "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
       "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cache-Control", "no-store"}};
  return *headers;
}

// Uses a content provider: the library would compress a plain body, which is slow. If the response
// has the header Connection: close, the provider fails at the end, so that the library closes the
// connection. The header alone does not close it.
void Respond(std::string content, const std::string& type, Response& response) {
  const auto body = std::make_shared<const std::string>(std::move(content));
  if (body->empty()) return response.set_content("", type);
  const bool closes = response.has_header("Connection");
  response.set_content_provider(
      body->size(), type, [body, closes](size_t offset, size_t length, httplib::DataSink& sink) {
        return sink.write(body->data() + offset, length) && !closes;
      });
}

void RespondError(const absl::Status& status, int http_status, Response& response) {
  response.status = http_status;
  Respond(ErrorJson(status), kUnaryType, response);
}

void RespondError(const absl::Status& status, Response& response) {
  RespondError(status, HttpStatus(status.code()), response);
}

// The library refuses a request that is too long, is not HTTP, or has a path or method without
// a handler.
void ExplainRefusal(const Request&, Response& response) {
  if (response.has_header("Content-Type")) return;  // the response has a body
  absl::Status status = absl::InvalidArgumentError("this is not a request of the gateway");
  if (response.status == 413) {
    status = absl::ResourceExhaustedError(
        absl::StrCat("the request is too long; at most ", kMostRequestBytes, " bytes"));
  }
  if (response.status == 404) status = absl::UnimplementedError("no such page or method");
  RespondError(status, response.status, response);
}

bool HasType(const Request& request, const std::string& type) {
  const std::string given = request.get_header_value("Content-Type");
  return given == type || absl::StartsWith(given, type + ";");
}

// Compares in a time that does not depend on the position of the first difference.
bool AreEqual(absl::string_view a, absl::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

// The header Connect-Timeout-Ms; `usual` if the request lacks it.
absl::StatusOr<absl::Duration> TimeoutOf(const Request& request, absl::Duration usual) {
  const std::string text = request.get_header_value("Connect-Timeout-Ms");
  if (text.empty()) return usual;
  if (int64_t ms = 0; text.size() <= 10 && absl::SimpleAtoi(text, &ms) && ms > 0) {
    return absl::Milliseconds(ms);
  }
  return absl::InvalidArgumentError(absl::StrCat(
      "Connect-Timeout-Ms: ", Quoted(text), " is not a whole number of 1 to 10 digits above 0"));
}

class WebServer {
 public:
  WebServer(const PageFiles& files, const Connection& connection)
      : files_(files), connection_(connection) {
    server_.new_task_queue = [] { return new httplib::ThreadPool(kMostConnections); };
    server_.set_payload_max_length(kMostRequestBytes);
    server_.set_error_handler(ExplainRefusal);
    server_.set_write_timeout(kPatience);
    server_.set_keep_alive_max_count(kMostCallsPerConnection);
    server_.set_default_headers(SafeHeaders());
    // The library's default would let two servers share a port.
    server_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    server_.set_pre_routing_handler([this](const auto& in, auto& out) { return Admit(in, out); });
    server_.Get("/([^/]*)", [this](const auto& in, auto& out) { SendFile(in, out); });
    server_.Post("/(.+)", [this](const auto& in, auto& out) { PassOn(in, out); });
  }

  // Opens the port; 0: a free one. Returns false if it is in use or not permitted.
  bool Bind(int port) {
    if (port == 0) {
      port = server_.bind_to_any_port(kLoopback);
    } else if (!server_.bind_to_port(kLoopback, port)) {
      port = -1;
    }
    const std::string suffix = port == 80 ? "" : absl::StrCat(":", port);  // as browsers write it
    hosts_ = {kLoopback + suffix, "localhost" + suffix};
    return port >= 0;
  }

  // The token is in the fragment, which browsers do not send.
  std::string Url() const { return absl::StrCat("http://", hosts_[0], "/#token=", token_); }
  void Serve() { server_.listen_after_bind(); }

 private:
  // The value of a header must be one of this page's hosts behind `scheme`.
  absl::Status CheckHost(const std::string& header, const std::string& scheme,
                         const Request& request) const {
    const std::string value = request.get_header_value(header);
    for (const std::string& host : hosts_) {
      if (value == scheme + host) return absl::OkStatus();
    }
    return absl::PermissionDeniedError(absl::StrCat(header, ": ", Quoted(value),
                                                    " is not this page; permitted: ", scheme,
                                                    absl::StrJoin(hosts_, ", " + scheme)));
  }

  absl::Status CheckToken(const Request& request) const {
    const std::string given = request.get_header_value("Authorization");
    if (AreEqual(given, absl::StrCat("Bearer ", token_))) return absl::OkStatus();
    return absl::UnauthenticatedError(
        given.empty()
            ? "the header Authorization: Bearer TOKEN is missing; the token is in the address that "
              "ballpiston web printed"
            : "wrong token: each run of ballpiston web prints an address with a new token");
  }

  // The library limits only bodies with Content-Length; it reads others to their end.
  static absl::Status CheckBody(const Request& request) {
    const bool is_limited = request.has_header("Content-Length") &&
                            !request.has_header("Transfer-Encoding") &&
                            !request.has_header("Content-Encoding");
    if (is_limited) return absl::OkStatus();
    return absl::InvalidArgumentError(
        "a call needs Content-Length, without Content-Encoding and Transfer-Encoding");
  }

  // Rejects requests that other web pages send, requests to another address, and calls without the
  // token, before their body is read.
  httplib::Server::HandlerResponse Admit(const Request& request, Response& response) const {
    absl::Status checked = CheckHost("Host", "", request);
    if (request.has_header("Origin")) checked.Update(CheckHost("Origin", "http://", request));
    if (request.method != "GET" && request.method != "HEAD") {
      checked.Update(CheckToken(request));
      checked.Update(CheckBody(request));
    }
    if (checked.ok()) return httplib::Server::HandlerResponse::Unhandled;
    response.set_header("Connection", "close");  // the unread body follows
    RespondError(checked, response);
    return httplib::Server::HandlerResponse::Handled;
  }

  void SendFile(const Request& request, Response& response) const {
    const std::string name = request.matches[1];
    const auto file = files_.find(name.empty() ? "index.html" : name);
    if (file == files_.end()) {
      response.status = 404;
      return Respond("no such page\n", "text/plain", response);
    }
    Respond(file->second.content, file->second.type, response);
  }

  void PassOn(const Request& request, Response& response) const {
    const auto* const method = FindMethod(request.matches[1].str());
    if (method == nullptr) {
      const std::string path = Quoted(request.matches[1].str());
      return RespondError(
          absl::UnimplementedError(absl::StrCat("no method ", path, " in this API")), 404,
          response);
    }
    const bool is_stream = method->server_streaming();
    const std::string type = is_stream ? kStreamType : kUnaryType;
    if (!HasType(request, type)) {
      return RespondError(absl::InvalidArgumentError(absl::StrCat("Content-Type must be ", type)),
                          415, response);
    }
    const auto timeout = TimeoutOf(request, is_stream ? absl::InfiniteDuration() : kCallTimeout);
    if (!timeout.ok()) return RespondError(timeout.status(), response);
    const Call call = [this, method, timeout](const std::string& json,
                                              const JsonReceiver& receive) {
      const auto& client = connection_.client;
      return NameServer(CallWithJson(client, *method, json, *timeout, receive), connection_);
    };
    if (is_stream) return PassOnStream(call, request.body, response);
    PassOnUnary(call, request.body, response);
  }

  // A call of the server with a request in JSON.
  using Call = std::function<absl::Status(const std::string& json, const JsonReceiver& receive)>;

  static void PassOnUnary(const Call& call, const std::string& request, Response& response) {
    std::string answer;
    const absl::Status status = call(request, [&answer](const std::string& json) {
      answer = json;
      return true;
    });
    if (!status.ok()) return RespondError(status, response);
    Respond(std::move(answer), kUnaryType, response);
  }

  // Sends each answer as it arrives: the call runs while the response is written.
  void PassOnStream(const Call& call, const std::string& body, Response& response) const {
    const std::shared_ptr<void> room(nullptr, [this](void*) { --streams_; });
    if (++streams_ > kMostStreams) {
      return RespondError(absl::ResourceExhaustedError(absl::StrCat(
                              "the gateway has ", kMostStreams, " open streams; end one first")),
                          response);
    }
    const auto request = OpenEnvelope(body);
    response.set_chunked_content_provider(kStreamType, [room, request, call](
                                                           size_t, httplib::DataSink& sink) {
      bool is_whole = true;  // false after a failed write
      const auto write = [&](const std::string& envelope) {
        is_whole = is_whole && sink.is_writable() && sink.write(envelope.data(), envelope.size());
        return is_whole;
      };
      const auto send = [&](const std::string& json) { return write(Envelope(json)); };
      const absl::Status status = request.ok() ? call(*request, send) : request.status();
      // If a message could not be written, the stream must not look complete.
      if (!write(EndOfStream(status))) return false;
      sink.done();
      return true;
    });
  }

  const PageFiles& files_;
  const Connection& connection_;
  const std::string token_ = NewRequestId();
  std::vector<std::string> hosts_;        // 127.0.0.1:PORT, localhost:PORT
  mutable std::atomic<int> streams_ = 0;  // open
  httplib::Server server_;
};

// Serves until the program ends.
VerbResult ServePage(const Options& options, Terminal& terminal) {
  const auto files = ReadPageFiles();
  if (!files.ok()) return files.status();
  return WithServer(options, terminal, [&](const Connection& connection) -> VerbResult {
    WebServer server(*files, connection);
    if (!server.Bind(static_cast<int>(options.port))) {
      return absl::InvalidArgumentError(
          absl::StrCat("--port ", options.port, ": the port is in use or not permitted"));
    }
    terminal.out << server.Url() << std::endl;
    terminal.Note(
        "Ctrl-C stops the page, but not the jobs. Keep the address secret: anyone who has it can "
        "use the server in your name.");
    server.Serve();
    return ExitCode::kDone;
  });
}

[[maybe_unused]] const bool kIsSet = (serve_page = &ServePage, true);

}  // namespace
}  // namespace ballpiston::client
