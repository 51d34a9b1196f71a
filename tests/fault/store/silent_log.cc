// Switches the log off. These tests make disks fail, and the log would report every failure.
#include "server/status/log.h"

namespace ballpiston::server {
namespace {

[[maybe_unused]] const bool kIsSilent = [] {
  SetLogLevel(Severity::kNone);
  return true;
}();

}  // namespace
}  // namespace ballpiston::server
