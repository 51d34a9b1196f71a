#include "server/observability/line_budget.h"

#include <utility>

namespace ballpiston::server {

std::optional<int64_t> LineBudget::Take(Clock::time_point now) {
  MutexLock lock(mutex_);
  if (written_ == 0 || now - begin_ >= period_) {
    begin_ = now;
    written_ = 0;
  }
  if (written_ == lines_) {
    ++left_out_;
    return std::nullopt;
  }
  ++written_;
  return std::exchange(left_out_, 0);
}

}  // namespace ballpiston::server
