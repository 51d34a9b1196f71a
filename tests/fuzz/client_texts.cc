// What the client reads: its user's input, a server's answers, a browser's calls.
#include "ballpiston/v1/ensemble.pb.h"
#include "client/command/number_list.h"
#include "client/library/error_text.h"
#include "client/library/server_address.h"
#include "client/output/json.h"
#include "client/output/point_output.h"
#include "client/web/connect_protocol.h"
#include "google/rpc/status.pb.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/spec.h"
#include "server/door/listen_address.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

// A specification as proto JSON. The client reads --spec in this form, and the gateway reads
// requests in it.
void CheckSpecFile(const std::string& json) {
  v1::EnsembleSpec spec, again;
  const absl::Status read = client::ReadJson(json, spec);
  if (!read.ok()) return Require(absl::IsInvalidArgument(read), "the error is INVALID_ARGUMENT");
  const std::string printed = client::Json(spec);
  if (printed == "null") return;  // a budget beyond what JSON has
  Require(client::ReadJson(printed, again).ok(), "the client can read its own output");
  server::Normalize(again);  // which drops the signs of zeros, as the reader does of -0
  server::Normalize(spec);
  Require(server::DeterministicBytes(again) == server::DeterministicBytes(spec),
          "the parsed specification equals the printed one");
}

void RequireTold(const absl::Status& error) {
  Require(absl::IsInvalidArgument(error), "the error is INVALID_ARGUMENT");
  Require(absl::StartsWith(error.message(), "'"), "the text is quoted");
}

// Whether the text has a range with a count of hundreds or with an exponent. Such lists take longer
// than all other inputs together, and differ only in their length.
bool IsLong(const std::string& text) {
  constexpr size_t kLong = 3;
  if (text.find(':') == std::string::npos) return false;
  size_t digits = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool exponent = (text[i] | 0x20) == 'e' && text.compare(i + 1, 1, "-") != 0;
    digits = exponent ? kLong : text[i] >= '0' && text[i] <= '9' ? digits + 1 : 0;
    if (digits >= kLong) return true;
  }
  return false;
}

void CheckList(const std::string& text) {
  const auto list = client::ParseNumberList(text);
  if (!list.ok()) return RequireTold(list.status());
  Require(!list->empty() && list->size() <= client::kMaxListLength, "a list has a length");
  Require(std::all_of(list->begin(), list->end(), [](double x) { return std::isfinite(x); }),
          "a number is finite");
}

void CheckShapes(const std::string& text) {
  const auto list = client::ParseShapeList(text);
  if (!list.ok()) return RequireTold(list.status());
  Require(!list->empty() && list->size() <= client::kMaxListLength, "a list has a length");
  for (const std::string& shape : *list) {
    const auto again = client::ParseShapeList(shape);
    Require(again.ok() && *again == std::vector<std::string>{shape}, "a shape has one spelling");
  }
}

// The client's numbers, counts, seeds, lists of numbers and lists of shapes.
void CheckNumberList(const std::string& text) {
  const auto number = client::ParseNumber(text);
  const auto count = client::ParseCount(text);
  const auto seed = client::ParseSeed(text);
  if (!number.ok()) RequireTold(number.status());
  if (!count.ok()) RequireTold(count.status());
  if (!seed.ok()) RequireTold(seed.status());
  Require(!number.ok() || std::isfinite(*number), "a number is finite");
  if (IsLong(text) && !IsOneIn(256, text)) return;
  CheckList(text);
  CheckShapes(text);
}

void CheckListening(const std::string& text) {
  const absl::StatusOr<server::ListenAddress> address = server::ParseListenAddress(text);
  if (!address.ok()) {
    Require(absl::IsInvalidArgument(address.status()), "the error is INVALID_ARGUMENT");
    return Require(absl::StrContains(address.status().message(), "--listen"), "the flag is named");
  }
  const auto again = server::ParseListenAddress(address->Text());
  Require(again.ok() && again->Text() == address->Text(), "an address is its own");
  const bool any_port = address->socket_path.empty() && address->port == 0;
  if (any_port || address->socket_path.size() > client::kMaxSocketPath) return;
  Require(client::GrpcTarget(address->Text()).ok(), "the client can call the server");
}

// Addresses, as client and server parse them: the client can call every address at which the server
// can listen.
void CheckServerAddress(const std::string& text) {
  if (text.find('\0') != std::string::npos) return;  // a program's arguments cannot contain it
  const absl::StatusOr<std::string> target = client::GrpcTarget(text);
  if (target.ok()) {
    Require(absl::StartsWith(*target, "unix:") || absl::StartsWith(*target, "dns:///"),
            "a target has a scheme");
  } else {
    Require(absl::IsInvalidArgument(target.status()), "the error is INVALID_ARGUMENT");
  }
  CheckListening(text);
}

void RequireRead(grpc::StatusCode code, const std::string& message, const std::string& details) {
  const absl::Status read = client::FromGrpc(grpc::Status(code, message, details));
  Require(static_cast<int>(read.code()) == static_cast<int>(code), "the code stays");
  const std::string reason = client::ErrorReason(read);
  Require(reason.size() <= details.size(), "a reason is the server's");
}

// How the client reads an error from a server, with and without details.
void CheckErrorText(const std::string& bytes) {
  constexpr int kCodes = 16;
  const auto code = static_cast<grpc::StatusCode>(1 + bytes.size() % kCodes);
  google::rpc::Status details;
  if (details.ParseFromString(bytes)) RequireRead(code, details.message(), bytes);
  RequireRead(code, bytes, "");
  RequireRead(grpc::StatusCode::RESOURCE_EXHAUSTED, bytes, "");
}

std::string Printed(const v1::ListResultsResponse& page, client::Format format) {
  std::ostringstream out;
  client::ResultWriter writer(format, out);
  writer.Begin(v1::EnsembleJob());
  for (const v1::PointResult& point : page.results()) writer.Add(point);
  writer.End();
  return out.str();
}

void RequirePrinted(const v1::ListResultsResponse& page, client::Format format) {
  const std::string printed = Printed(page, format);
  const bool may_be_empty = format == client::Format::kJsonl && page.results().empty();
  Require(may_be_empty || printed.ends_with("\n"), "what is printed ends with its line");
}

// The client's printing of results that a server sent, in every format.
void CheckPrintedResult(const v1::ListResultsResponse& page, const std::string& bytes) {
  RequirePrinted(page, bytes.size() % 2 == 0 ? client::Format::kTable : client::Format::kCsv);
  if (!IsOneIn(128, bytes)) return;  // slow, and nearly all of it the library's
  RequirePrinted(page, bytes.size() % 2 == 0 ? client::Format::kJson : client::Format::kJsonl);
}

// A call of the gateway: a line with the path, then the body.
void CheckGatewayRequest(const std::string& bytes) {
  const size_t end = bytes.find('\n');
  const std::string path = bytes.substr(0, end);
  const std::string body = end == std::string::npos ? "" : bytes.substr(end + 1);
  const auto opened = client::OpenEnvelope(body);
  Require(!opened.ok() || client::Envelope(*opened) == body,
          "an opened envelope can be made again");
  const auto* const method = client::FindMethod(path);
  if (method == nullptr) return;
  Require(path.starts_with("ballpiston.v1."), "only this API's methods are found");
}

std::vector<std::string> Watch() {
  return {"ballpiston.v1.EnsembleService/WatchEnsembleJob\n" +
          client::Envelope(R"({"name": "ensembleJobs/1"})")};
}

}  // namespace

std::vector<FuzzTarget> ClientTargets() {
  return {
      {"spec_file", CheckSpecFile},
      {"number_list", CheckNumberList},
      {"server_address", CheckServerAddress},
      {"error_text", CheckErrorText, &google::rpc::Status::default_instance()},
      OfMessage<v1::ListResultsResponse, CheckPrintedResult>("printed_result"),
      {"gateway_request", CheckGatewayRequest, nullptr, Watch},
  };
}

}  // namespace ballpiston::fuzz
