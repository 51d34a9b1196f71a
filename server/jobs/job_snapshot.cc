#include "server/jobs/job_snapshot.h"

namespace ballpiston::server {

std::shared_ptr<const JobSnapshot> SharedSnapshot::Get(uint64_t change,
                                                       std::chrono::milliseconds max_age,
                                                       Make make) {
  std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  const bool fits = last_ != nullptr && (last_->change >= change || now - made_ < max_age);
  if (!fits) {
    last_ = std::make_shared<const JobSnapshot>(make());
    made_ = now;
  }
  return last_;
}

}  // namespace ballpiston::server
