#include "server/observability/call_statistics.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "google/protobuf/descriptor.h"

namespace ballpiston::server {
namespace {

using MethodType = CallStatistics::MethodType;

constexpr std::array<const char*, 4> kTypeNames = {  // by MethodType
    "unary", "client_stream", "server_stream", "bidi_stream"};

MethodType TypeOf(const google::protobuf::MethodDescriptor& method) {
  if (method.client_streaming()) {
    return method.server_streaming() ? MethodType::BIDI_STREAMING : MethodType::CLIENT_STREAMING;
  }
  return method.server_streaming() ? MethodType::SERVER_STREAMING : MethodType::UNARY;
}

prometheus::Labels LabelsOf(absl::string_view path, MethodType type) {
  const std::pair<std::string, std::string> names =
      absl::StrSplit(absl::StripPrefix(path, "/"), absl::MaxSplits('/', 1));
  return {{"grpc_service", names.first},
          {"grpc_method", names.second},
          {"grpc_type", kTypeNames[static_cast<size_t>(type)]}};
}

}  // namespace

void MethodCounts::Ended(absl::StatusCode code, double duration) const {
  const auto known = static_cast<size_t>(code);
  ended[known < ended.size() ? known : static_cast<size_t>(absl::StatusCode::kUnknown)]
      ->Increment();
  seconds->Observe(duration);
}

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

MethodCounts CallStatistics::NewCounts(const std::string& path, MethodType type) {
  // Upper bounds, in seconds; prometheus-cpp adds an unbounded bucket.
  const std::vector<double> buckets = {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30};
  prometheus::Labels labels = LabelsOf(path, type);
  MethodCounts counts{&began_.Add(labels), {}, &seconds_.Add(labels, buckets)};
  for (size_t code = 0; code < counts.ended.size(); ++code) {
    labels["grpc_code"] = absl::StatusCodeToString(static_cast<absl::StatusCode>(code));
    counts.ended[code] = &ended_.Add(labels);
  }
  return counts;
}

const MethodCounts& CallStatistics::Of(const std::string& path, MethodType type) {
  MutexLock lock(mutex_);
  const auto [method, added] = methods_.try_emplace(path);
  if (added) method->second = NewCounts(path, type);
  return method->second;
}

void CallStatistics::Expect(const std::string& service) {
  const auto* described =
      google::protobuf::DescriptorPool::generated_pool()->FindServiceByName(service);
  if (described == nullptr) return;
  for (int i = 0; i < described->method_count(); ++i) {
    const google::protobuf::MethodDescriptor& method = *described->method(i);
    Of(absl::StrCat("/", service, "/", method.name()), TypeOf(method));
  }
}

}  // namespace ballpiston::server
