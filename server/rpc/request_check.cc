#include "server/rpc/request_check.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/generated_enum_reflection.h"
#include "server/convert/timestamp.h"
#include "server/store/job_name.h"

namespace ballpiston::server {
namespace {

constexpr int32_t kHighestPriority = 100;
constexpr int kDefaultPageSize = 50;
constexpr int kMaxPageSize = 1000;

// A request of 4 MiB can hold four million wrong values.
constexpr size_t kMaxViolationsOfList = 100;

constexpr int64_t kFirstSecond = -62'135'596'800;  // 0001-01-01T00:00:00Z
constexpr int64_t kLastSecond = 253'402'300'799;   // 9999-12-31T23:59:59Z
constexpr int32_t kMaxNanos = 999'999'999;

std::string Quoted(const std::string& text) {
  return absl::StrCat("\"", absl::CEscape(text.substr(0, 100)), "\"");
}

bool IsUuid(const std::string& text) {
  if (text.size() != 36) return false;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool dash = i == 8 || i == 13 || i == 18 || i == 23;
    const auto c = static_cast<unsigned char>(text[i]);
    if (dash ? c != '-' : !absl::ascii_isxdigit(c)) return false;
  }
  return true;
}

// The names of all values but 0, which is the unspecified one.
std::string PermittedNames(const google::protobuf::EnumDescriptor& type) {
  std::string names;
  for (int i = 0; i < type.value_count(); ++i) {
    if (type.value(i)->number() == 0) continue;
    absl::StrAppend(&names, names.empty() ? "" : ", ", type.value(i)->name());
  }
  return names;
}

}  // namespace

void RequestCheck::Add(std::string field, std::string description) {
  violations_.push_back({std::move(field), std::move(description)});
}

absl::Status RequestCheck::status() const {
  return ok() ? absl::OkStatus() : InvalidRequest(violations_);
}

void RequestCheck::Range(const char* field, int64_t value, int64_t first, int64_t last) {
  if (value >= first && value <= last) return;
  Add(field, absl::StrCat("is ", value, "; permitted: ", first, " to ", last));
}

std::string RequestCheck::JobId(const char* field, const std::string& name) {
  if (auto id = JobIdOf(name)) return *std::move(id);
  Add(field, absl::StrCat(Quoted(name),
                          " is not the name of a job; permitted: ensembleJobs/{id}, with an id of "
                          "lower-case letters, digits and -"));
  return std::string();
}

std::string RequestCheck::RequestId(const std::string& request_id) {
  if (request_id.empty()) return request_id;
  if (IsUuid(request_id)) return absl::AsciiStrToLower(request_id);
  Add("request_id",
      absl::StrCat(Quoted(request_id), " is not a UUID like 123e4567-e89b-12d3-a456-426614174000"));
  return std::string();
}

int32_t RequestCheck::Priority(const char* field, int32_t priority) {
  Range(field, priority, -kHighestPriority, kHighestPriority);
  return priority;
}

namespace {

bool IsLabelText(const std::string& text, const char* permitted) {
  constexpr size_t kLongest = 63;
  return !text.empty() && text.size() <= kLongest && text.find_first_not_of(permitted) == text.npos;
}

bool IsLabelKey(const std::string& key) {
  return IsLabelText(key, "abcdefghijklmnopqrstuvwxyz0123456789_.-") &&
         absl::ascii_islower(static_cast<unsigned char>(key[0]));
}

bool IsLabelValue(const std::string& value) {
  return IsLabelText(value,
                     "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.:/@+-");
}

}  // namespace

Labels RequestCheck::LabelsIn(const char* field, const LabelsField& message) {
  const Labels labels(message.begin(), message.end());
  if (labels.size() > kMostLabels) {
    Add(field, absl::StrCat("has ", labels.size(), " labels; permitted: at most ", kMostLabels));
    return {};
  }
  for (const auto& [key, value] : labels) {
    if (!IsLabelKey(key)) {
      Add(field, absl::StrCat("has the key ", Quoted(key),
                              "; permitted: 1 to 63 of a-z, 0-9 and _ . -, first a letter"));
    }
    if (!IsLabelValue(value)) {
      Add(field, absl::StrCat("has the value ", Quoted(value), " of ", Quoted(key),
                              "; permitted: 1 to 63 letters, digits and _ . : / @ + -"));
    }
  }
  return labels;
}

// ---- updates ----

JobChange RequestCheck::Change(const v1::UpdateEnsembleJobRequest& request) {
  constexpr char kPermitted[] = "; permitted: pinned, priority, labels";
  JobChange change;
  const auto& paths = request.update_mask().paths();
  if (paths.empty()) Add("update_mask", absl::StrCat("is empty", kPermitted));
  for (const std::string& path : paths) {
    if (path == "pinned") {
      change.pinned = request.job().pinned();
    } else if (path == "priority") {
      change.priority = Priority("job.priority", request.job().priority());
    } else if (path == "labels") {
      change.labels = LabelsIn("job.labels", request.job().labels());
    } else {
      Add("update_mask", absl::StrCat("has ", Quoted(path), kPermitted));
    }
    if (violations_.size() >= kMaxViolationsOfList) break;
  }
  return change;
}

// ---- lists ----

template <typename Enum>
std::set<Enum> RequestCheck::Values(const char* field,
                                    const google::protobuf::RepeatedField<int>& list) {
  const google::protobuf::EnumDescriptor& type = *google::protobuf::GetEnumDescriptor<Enum>();
  std::set<Enum> values;
  size_t violations = 0;
  for (int i = 0; i < list.size() && violations < kMaxViolationsOfList; ++i) {
    const int value = list[i];
    if (value != 0 && type.FindValueByNumber(value) != nullptr) {
      values.insert(static_cast<Enum>(value));
      continue;
    }
    ++violations;
    Add(absl::StrCat(field, "[", i, "]"),
        absl::StrCat("is ", value, "; permitted: ", PermittedNames(type)));
  }
  return values;
}

JobFilter RequestCheck::Filter(const v1::ListEnsembleJobsRequest& request) {
  JobFilter filter;
  filter.states = Values<JobState>("states", request.states());
  filter.experiments = Values<v1::EnsembleSpec::Experiment>("experiments", request.experiments());
  filter.labels = LabelsIn("labels", request.labels());
  if (!request.has_since()) return filter;
  const auto& since = request.since();
  Range("since.seconds", since.seconds(), kFirstSecond, kLastSecond);
  Range("since.nanos", since.nanos(), 0, kMaxNanos);
  filter.since = TimeOf(since);
  return filter;
}

int RequestCheck::PageSize(int32_t page_size) {
  if (page_size < 0) {
    Add("page_size", absl::StrCat("is ", page_size, "; permitted: 0 (for ", kDefaultPageSize,
                                  ") to ", kMaxPageSize));
  }
  return page_size == 0 ? kDefaultPageSize : std::min<int>(page_size, kMaxPageSize);
}

int64_t RequestCheck::PageStart(const std::string& token, const std::string& list, int64_t first) {
  if (token.empty()) return first;
  const auto page = ParseToken<storage::PageToken>(token);
  if (page && page->list() == list && page->start() >= 0) return page->start();
  Add("page_token", absl::StrCat(Quoted(token), " is not a token of this list with these filters"));
  return first;
}

}  // namespace ballpiston::server
