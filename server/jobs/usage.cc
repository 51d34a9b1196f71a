#include "server/jobs/usage.h"

#include "absl/strings/str_cat.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

int64_t DayOf(absl::Time time) {
  return absl::Floor(time - absl::UnixEpoch(), absl::Hours(24)) / absl::Hours(24);
}

}  // namespace

int64_t Usage::FirstDay(absl::Time now) { return DayOf(now) - kQuotaDays + 1; }

void Usage::AddStored(const std::string& principal, int64_t jobs, int64_t bytes) {
  MutexLock lock(mutex_);
  PrincipalUsage& stored = stored_[principal];
  stored.jobs += jobs;
  stored.bytes += bytes;
  if (stored.jobs == 0) stored_.erase(principal);
}

void Usage::AddWork(const std::string& principal, absl::Time now, double seconds) {
  const Day day = {principal, DayOf(now)};
  MutexLock lock(mutex_);
  work_[day] += seconds;
  new_work_[day] += seconds;
}

void Usage::AddStoredWork(const DayOfWork& work) {
  MutexLock lock(mutex_);
  work_[{work.principal, work.day}] += work.seconds;
}

absl::Status Usage::Check(const std::string& principal, absl::Time now,
                          const Limits& limits) const {
  const PrincipalUsage own = Of(principal, now);
  const auto most_bytes = static_cast<double>(limits.max_store_bytes_per_principal);
  if (most_bytes > 0 && static_cast<double>(own.bytes) >= most_bytes) {
    return LimitExceeded("TOO_MANY_STORED_BYTES",
                         absl::StrCat(principal, "'s jobs take ", own.bytes,
                                      " bytes in the store: delete some of them"),
                         "max-store-bytes-per-principal", most_bytes);
  }
  const double most_seconds = limits.max_processor_seconds_per_principal;
  if (most_seconds == 0 || own.seconds < most_seconds) return absl::OkStatus();
  return LimitExceeded("TOO_MANY_SECONDS",
                       absl::StrCat(principal, "'s jobs have taken ", own.seconds,
                                    " s of processor time in ", kQuotaDays, " days"),
                       "max-processor-seconds-per-principal", most_seconds);
}

PrincipalUsage Usage::Of(const std::string& principal, absl::Time now) const {
  MutexLock lock(mutex_);
  return Locked(principal, now);
}

PrincipalUsage Usage::Locked(const std::string& principal, absl::Time now) const {
  const auto stored = stored_.find(principal);
  PrincipalUsage usage = stored == stored_.end() ? PrincipalUsage{} : stored->second;
  const auto end = work_.lower_bound({principal, DayOf(now) + 1});
  for (auto day = work_.lower_bound({principal, FirstDay(now)}); day != end; ++day) {
    usage.seconds += day->second;
  }
  return usage;
}

std::map<std::string, PrincipalUsage> Usage::All(absl::Time now) const {
  MutexLock lock(mutex_);
  std::map<std::string, PrincipalUsage> all = stored_;
  for (const auto& [day, seconds] : work_) all.try_emplace(day.first);
  for (auto& [principal, usage] : all) usage = Locked(principal, now);
  return all;
}

std::vector<DayOfWork> Usage::TakeNewWork(absl::Time now) {
  const int64_t first = FirstDay(now);
  MutexLock lock(mutex_);
  std::erase_if(work_, [=](const auto& work) { return work.first.second < first; });
  std::vector<DayOfWork> work;
  for (const auto& [day, seconds] : new_work_) work.push_back({day.first, day.second, seconds});
  new_work_.clear();
  return work;
}

}  // namespace ballpiston::server
