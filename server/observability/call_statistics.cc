#include "server/observability/call_statistics.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "google/protobuf/descriptor.h"

namespace ballpiston::server {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;

const char* TypeOf(const google::protobuf::MethodDescriptor& method) {
  if (method.client_streaming()) return method.server_streaming() ? "bidi_stream" : "client_stream";
  return method.server_streaming() ? "server_stream" : "unary";
}

}  // namespace

MethodCounts::MethodCounts(absl::string_view path, absl::string_view type) {
  path = absl::StripPrefix(path, "/");
  const size_t slash = std::min(path.find('/'), path.size());
  zero_.service = std::string(path.substr(0, slash));
  zero_.method = std::string(absl::StripPrefix(path.substr(slash), "/"));
  zero_.type = std::string(type);
}

void MethodCounts::Ended(absl::StatusCode code, double seconds) {
  const auto known = std::min(static_cast<size_t>(code), kStatusCodes);
  ended_[known == kStatusCodes ? static_cast<size_t>(absl::StatusCode::kUnknown) : known].fetch_add(
      1, kRelaxed);
  const auto bound = std::lower_bound(kDurationBounds.begin(), kDurationBounds.end(), seconds);
  durations_[static_cast<size_t>(bound - kDurationBounds.begin())].fetch_add(1, kRelaxed);
  seconds_.fetch_add(seconds, kRelaxed);
}

MethodCounts::Totals MethodCounts::Read() const {
  Totals totals = zero_;
  totals.began = began_.load(kRelaxed);
  for (size_t i = 0; i < ended_.size(); ++i) totals.ended[i] = ended_[i].load(kRelaxed);
  for (size_t i = 0; i < durations_.size(); ++i) totals.durations[i] = durations_[i].load(kRelaxed);
  totals.seconds = seconds_.load(kRelaxed);
  return totals;
}

MethodCounts& CallStatistics::Of(absl::string_view path, absl::string_view type) {
  const std::string_view key(path.data(), path.size());
  {
    std::shared_lock lock(mutex_);
    const auto found = methods_.find(key);
    if (found != methods_.end()) return *found->second;
  }
  std::unique_lock lock(mutex_);
  std::unique_ptr<MethodCounts>& counts = methods_[std::string(key)];
  if (counts == nullptr) counts = std::make_unique<MethodCounts>(path, type);
  return *counts;
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

std::vector<MethodCounts::Totals> CallStatistics::Read() const {
  std::shared_lock lock(mutex_);
  std::vector<MethodCounts::Totals> all;
  for (const auto& [path, counts] : methods_) all.push_back(counts->Read());
  return all;
}

}  // namespace ballpiston::server
