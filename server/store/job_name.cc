#include "server/store/job_name.h"

#include <cstring>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "server/host.h"

namespace ballpiston::server {
namespace {

constexpr char kCollection[] = "ensembleJobs/";
constexpr char kResults[] = "/results/";
constexpr size_t kMaxIdLength = 63;

bool IsId(absl::string_view id) {
  return !id.empty() && id.size() <= kMaxIdLength &&
         id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == id.npos;
}

}  // namespace

std::string JobName(const std::string& id) { return absl::StrCat(kCollection, id); }

std::string ResultName(const std::string& job_id, int64_t point) {
  return absl::StrCat(JobName(job_id), kResults, point);
}

std::optional<std::string> JobIdOf(const std::string& name) {
  absl::string_view id = name;
  if (!absl::ConsumePrefix(&id, kCollection) || !IsId(id)) return std::nullopt;
  return std::string(id);
}

std::optional<ResultId> ResultIdOf(const std::string& name) {
  const size_t end = name.find(kResults);
  if (end == std::string::npos) return std::nullopt;
  const std::optional<std::string> job = JobIdOf(name.substr(0, end));
  const std::string index = name.substr(end + std::strlen(kResults));
  int64_t point = 0;
  const bool is_number = absl::SimpleAtoi(index, &point) && absl::StrCat(point) == index;
  if (!job || !is_number || point < 0) return std::nullopt;
  return ResultId{*job, point};
}

std::string RandomId() { return absl::StrFormat("%016x", RandomBits()); }

}  // namespace ballpiston::server
