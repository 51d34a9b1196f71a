#include "server/observability/call_statistics.h"

#include <array>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "google/protobuf/descriptor.h"

namespace ballpiston::server {
namespace {

using MethodType = CallStatistics::MethodType;

constexpr int kLastCode = 16;  // UNAUTHENTICATED

// Upper bounds, in seconds; prometheus-cpp adds an unbounded bucket.
const std::vector<double> kBuckets = {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30};

constexpr std::array<const char*, 4> kTypeNames = {  // by MethodType
    "unary", "client_stream", "server_stream", "bidi_stream"};

MethodType TypeOf(const google::protobuf::MethodDescriptor& method) {
  if (method.client_streaming()) {
    return method.server_streaming() ? MethodType::BIDI_STREAMING : MethodType::CLIENT_STREAMING;
  }
  return method.server_streaming() ? MethodType::SERVER_STREAMING : MethodType::UNARY;
}

}  // namespace

CallStatistics::CallStatistics(prometheus::Registry& registry)
    : began_(prometheus::BuildCounter()
                 .Name("grpc_server_started_total")
                 .Help("Calls that began.")
                 .Register(registry)),
      ended_(prometheus::BuildCounter()
                 .Name("grpc_server_handled_total")
                 .Help("Calls that ended, by code.")
                 .Register(registry)),
      seconds_(prometheus::BuildHistogram()
                   .Name("grpc_server_handling_seconds")
                   .Help("From a call's begin to its end.")
                   .Register(registry)) {}

prometheus::Labels CallStatistics::Of(const std::string& path, MethodType type) {
  const std::pair<std::string, std::string> names =
      absl::StrSplit(absl::StripPrefix(path, "/"), absl::MaxSplits('/', 1));
  return {{"grpc_service", names.first},
          {"grpc_method", names.second},
          {"grpc_type", kTypeNames[static_cast<size_t>(type)]}};
}

void CallStatistics::Began(const prometheus::Labels& method) { began_.Add(method).Increment(); }

void CallStatistics::Ended(const prometheus::Labels& method, absl::StatusCode code,
                           double seconds) {
  EndedWith(code, method).Increment();
  SecondsOf(method).Observe(seconds);
}

prometheus::Histogram& CallStatistics::SecondsOf(const prometheus::Labels& method) {
  return seconds_.Add(method, kBuckets);
}

prometheus::Counter& CallStatistics::EndedWith(absl::StatusCode code, prometheus::Labels method) {
  method["grpc_code"] = absl::StatusCodeToString(code);
  return ended_.Add(method);
}

void CallStatistics::Expect(const std::string& service) {
  const auto* described =
      google::protobuf::DescriptorPool::generated_pool()->FindServiceByName(service);
  if (described == nullptr) return;
  for (int i = 0; i < described->method_count(); ++i) {
    const google::protobuf::MethodDescriptor& method = *described->method(i);
    const auto labels = Of(absl::StrCat("/", service, "/", method.name()), TypeOf(method));
    began_.Add(labels);
    SecondsOf(labels);
    for (int code = 0; code <= kLastCode; ++code) {
      EndedWith(static_cast<absl::StatusCode>(code), labels);
    }
  }
}

}  // namespace ballpiston::server
