// Switches the log off. These tests make disks fail, and the log would report every failure.
#include "gtest/gtest.h"
#include "server/status/log.h"

namespace ballpiston::server {
namespace {

class SilentLog : public testing::Environment {
  void SetUp() override { SetLogLevel(Severity::kNone); }
};

[[maybe_unused]] const auto* const kSilentLog = testing::AddGlobalTestEnvironment(new SilentLog);

}  // namespace
}  // namespace ballpiston::server
