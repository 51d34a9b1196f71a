#include "server/api/turns.h"

namespace ballpiston::server {

Turns::Turn::Turn(Turns& turns, const std::string& principal)
    : turns_(turns), principal_(principal) {
  turns_.Take(principal_);
}

Turns::Turn::~Turn() { turns_.GiveBack(principal_); }

void Turns::Take(const std::string& principal) {
  MutexLock lock(mutex_);
  while (taken_ >= all_ || of_[principal] >= of_one_) changed_.Wait(mutex_);
  ++taken_;
  ++of_[principal];
}

void Turns::GiveBack(const std::string& principal) {
  {
    MutexLock lock(mutex_);
    --taken_;
    if (--of_[principal] == 0) of_.erase(principal);
  }
  changed_.NotifyAll();
}

}  // namespace ballpiston::server
