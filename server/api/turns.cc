#include "server/api/turns.h"

namespace ballpiston::server {

Turns::Turn::Turn(Turns& turns, const std::string& principal)
    : turns_(turns), principal_(principal) {
  turns_.Take(principal_);
}

Turns::Turn::~Turn() { turns_.GiveBack(principal_); }

void Turns::Take(const std::string& principal) {
  MutexLock lock(mutex_);
  OfPrincipal& own = principals_[principal];
  ++own.calls;
  while (taken_ >= all_ || own.taken >= of_one_) own.changed.Wait(mutex_);
  ++taken_;
  ++own.taken;
}

void Turns::GiveBack(const std::string& principal) {
  MutexLock lock(mutex_);
  const auto own = principals_.find(principal);
  --taken_;
  --own->second.taken;
  if (--own->second.calls == 0) principals_.erase(own);
  for (auto& [name, other] : principals_) other.changed.NotifyOne();
}

}  // namespace ballpiston::server
