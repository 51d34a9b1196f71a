#include "server/jobs/active_points.h"

#include "absl/strings/str_cat.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

absl::Status TooMany(const std::string& what, const std::string& flag, int64_t limit) {
  return LimitExceeded("TOO_MANY_ACTIVE_POINTS", what, flag, static_cast<double>(limit));
}

}  // namespace

absl::Status ActivePoints::Check(const std::string& principal, int64_t points,
                                 const Limits& limits) const {
  MutexLock lock(mutex_);
  if (limits.max_active_points > 0 && all_ + points > limits.max_active_points) {
    return TooMany(absl::StrCat("active jobs would have ", all_ + points, " points with this one"),
                   "max-active-points", limits.max_active_points);
  }
  const auto found = of_principals_.find(principal);
  const int64_t own = points + (found == of_principals_.end() ? 0 : found->second);
  const int64_t most = limits.max_active_points_per_principal;
  if (most == 0 || own <= most) return absl::OkStatus();
  return TooMany(
      absl::StrCat(principal, "'s active jobs would have ", own, " points with this one"),
      "max-active-points-per-principal", most);
}

void ActivePoints::Add(const std::string& job, const std::string& principal, int64_t points) {
  MutexLock lock(mutex_);
  if (!grids_.try_emplace(job, Grid{principal, points}).second) return;
  of_principals_[principal] += points;
  all_ += points;
}

void ActivePoints::Remove(const std::string& job) {
  MutexLock lock(mutex_);
  const auto grid = grids_.find(job);
  if (grid == grids_.end()) return;
  const auto own = of_principals_.find(grid->second.principal);
  own->second -= grid->second.points;
  all_ -= grid->second.points;
  if (own->second == 0) of_principals_.erase(own);
  grids_.erase(grid);
}

}  // namespace ballpiston::server
