#include "tests/support/preamble.h"

namespace ballpiston {
namespace {

TEST(TestMain, NamesATestThatTakes15Minutes) {
  EXPECT_GT(alarm(0), 0u);  // the seconds until the alarm
  testing::internal::CaptureStderr();
  raise(SIGALRM);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "[  HANGS?  ] 15 minutes without another test since the start of "
            "TestMain.NamesATestThatTakes15Minutes\n");
}

}  // namespace
}  // namespace ballpiston
