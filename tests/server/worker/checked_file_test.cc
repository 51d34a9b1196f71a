#include "server/worker/checked_file.h"

#include <string>

#include "gmock/gmock.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string SomePayload() {
  std::string payload;
  for (int i = 0; i < 100; ++i) payload.push_back(static_cast<char>(i * 37));
  return payload;
}

absl::StatusOr<std::string> PayloadOf(absl::string_view file) {
  const absl::StatusOr<absl::string_view> payload = TakeFrame(file);
  if (!payload.ok()) return payload.status();
  return std::string(payload->data(), payload->size());
}

std::string SomeFile() { return FrameOf(SomePayload()); }

TEST(CheckedFile, ThePayloadComesBack) {
  EXPECT_THAT(PayloadOf(SomeFile()), IsOkAndHolds(SomePayload()));
  EXPECT_THAT(PayloadOf(FrameOf("")), IsOkAndHolds(""));
  EXPECT_EQ(SomeFile().size(), SomePayload().size() + kFrameBytes);
}

// All other values of every byte: of the header, the payload and the checksum.
TEST(CheckedFile, AChangedByteIsRejected) {
  const std::string good = SomeFile();
  for (size_t at = 0; at < good.size(); ++at) {
    std::string file = good;
    for (int change = 1; change < 256; ++change) {
      file[at] = static_cast<char>(good[at] ^ change);
      ASSERT_FALSE(PayloadOf(file).ok()) << "byte " << at << " changed by " << change;
    }
  }
}

TEST(CheckedFile, AShorterFileIsRejected) {
  const std::string good = SomeFile();
  for (size_t size = 0; size < good.size(); ++size) {
    ASSERT_THAT(PayloadOf(good.substr(0, size)),
                StatusIs(absl::StatusCode::kOutOfRange, HasSubstr("truncated")))
        << size;
  }
}

TEST(CheckedFile, TheBytesAfterAFrameAreLeft) {
  const std::string file = SomeFile() + FrameOf("second") + "x";
  absl::string_view rest = file;
  EXPECT_THAT(TakeFrame(rest), IsOkAndHolds(SomePayload()));
  EXPECT_THAT(TakeFrame(rest), IsOkAndHolds("second"));
  EXPECT_FALSE(TakeFrame(rest).ok());
  EXPECT_EQ(rest, "x");
}

TEST(CheckedFile, AnotherFileIsRefused) {
  EXPECT_THAT(PayloadOf("#!/bin/bash\necho this is a script of some length\n"),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("not a file of ballpiston")));
}

TEST(CheckedFile, ANewerFormatIsRefusedWithBothVersions) {
  std::string file = SomeFile();
  file[8] = 2;
  EXPECT_THAT(PayloadOf(file), StatusIs(absl::StatusCode::kUnimplemented,
                                        AllOf(HasSubstr("version 2"), HasSubstr("version 1"))));
}

}  // namespace
}  // namespace ballpiston::server
