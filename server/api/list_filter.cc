#include "server/api/list_filter.h"

#include <cstdint>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/generated_enum_reflection.h"
#include "google/protobuf/repeated_field.h"
#include "google/protobuf/timestamp.pb.h"

namespace ballpiston::server {
namespace {

// A request of 4 MiB can hold four million wrong values.
constexpr int kMaxViolationsOfList = 100;

constexpr int64_t kFirstSecond = -62'135'596'800;  // 0001-01-01T00:00:00Z
constexpr int64_t kLastSecond = 253'402'300'799;   // 9999-12-31T23:59:59Z
constexpr int32_t kMaxNanos = 999'999'999;

// The names of all values but 0, which is the unspecified one.
std::string PermittedNames(const google::protobuf::EnumDescriptor& type) {
  std::string names;
  for (int i = 0; i < type.value_count(); ++i) {
    if (type.value(i)->number() == 0) continue;
    absl::StrAppend(&names, names.empty() ? "" : ", ", type.value(i)->name());
  }
  return names;
}

template <typename Enum>
std::set<Enum> ReadList(const char* field, const google::protobuf::RepeatedField<int>& list,
                        RequestCheck& check) {
  const google::protobuf::EnumDescriptor& type = *google::protobuf::GetEnumDescriptor<Enum>();
  std::set<Enum> values;
  int violations = 0;
  for (int i = 0; i < list.size() && violations < kMaxViolationsOfList; ++i) {
    const int value = list[i];
    if (value != 0 && type.FindValueByNumber(value) != nullptr) {
      values.insert(static_cast<Enum>(value));
      continue;
    }
    ++violations;
    check.Add(absl::StrCat(field, "[", i, "]"),
              absl::StrCat("is ", value, "; permitted: ", PermittedNames(type)));
  }
  return values;
}

void CheckRange(const char* field, int64_t value, int64_t first, int64_t last,
                RequestCheck& check) {
  if (value >= first && value <= last) return;
  check.Add(field, absl::StrCat("is ", value, "; permitted: ", first, " to ", last));
}

absl::Time ReadTime(const google::protobuf::Timestamp& time, RequestCheck& check) {
  CheckRange("since.seconds", time.seconds(), kFirstSecond, kLastSecond, check);
  CheckRange("since.nanos", time.nanos(), 0, kMaxNanos, check);
  return absl::FromUnixSeconds(time.seconds()) + absl::Nanoseconds(time.nanos());
}

}  // namespace

JobFilter ReadListFilter(const v1::ListEnsembleJobsRequest& request, RequestCheck& check) {
  JobFilter filter;
  filter.states = ReadList<JobState>("states", request.states(), check);
  filter.experiments =
      ReadList<v1::EnsembleSpec::Experiment>("experiments", request.experiments(), check);
  if (request.has_since()) filter.since = ReadTime(request.since(), check);
  return filter;
}

}  // namespace ballpiston::server
