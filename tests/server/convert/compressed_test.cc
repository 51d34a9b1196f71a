#include "server/convert/compressed.h"

#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

constexpr size_t kMost = 1000;

std::string SomeBytes() {
  std::string bytes;
  for (int i = 0; i < 100; ++i) bytes.push_back(static_cast<char>(i * 37));
  return bytes;
}

// Decompresses a single stream.
absl::StatusOr<std::string> ContentsOf(absl::string_view stream) {
  return TakeCompressed(stream, kMost);
}

// Tries every other value of each byte of header, contents and checksum.
TEST(Compressed, AChangedByteIsDetectedOrHarmless) {
  const std::string good = Compressed(SomeBytes());
  for (size_t i = 0; i < 255 * good.size(); ++i) {
    std::string changed = good;
    changed[i / 255] = static_cast<char>(good[i / 255] ^ (1 + i % 255));
    ASSERT_EQ(ContentsOf(changed).value_or(SomeBytes()), SomeBytes()) << i;
  }
}

TEST(Compressed, AShorterStreamIsTruncated) {
  const std::string good = Compressed(SomeBytes());
  for (size_t size = 0; size < good.size(); ++size) {
    ASSERT_THAT(ContentsOf(good.substr(0, size)),
                StatusIs(absl::StatusCode::kOutOfRange, HasSubstr("truncated")))
        << size;
  }
}

TEST(Compressed, BytesAfterAStreamRemain) {
  const std::string bytes = Compressed(SomeBytes()) + Compressed("second") + "x";
  EXPECT_EQ(Uncompressed(bytes), std::nullopt);
  absl::string_view rest = bytes;
  EXPECT_THAT(TakeCompressed(rest, kMost), IsOkAndHolds(SomeBytes()));
  EXPECT_THAT(TakeCompressed(rest, kMost), IsOkAndHolds("second"));
  EXPECT_FALSE(TakeCompressed(rest, kMost).ok());
  EXPECT_EQ(rest, "x");
}

TEST(Compressed, AFileOfAnotherFormatIsDataLoss) {
  EXPECT_THAT(ContentsOf("#!/bin/bash\necho this is a script of some length\n"),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("not a file of ballpiston")));
}

TEST(Compressed, AStreamOfTooManyBytesIsDataLoss) {
  EXPECT_THAT(ContentsOf(Compressed(std::string(kMost, 'a'))),
              IsOkAndHolds(testing::SizeIs(kMost)));
  for (const size_t size : {kMost + 1, size_t{10'000'000}}) {
    EXPECT_THAT(ContentsOf(Compressed(std::string(size, 'a'))),
                StatusIs(absl::StatusCode::kDataLoss, HasSubstr("bytes when unpacked")));
  }
}

}  // namespace
}  // namespace ballpiston::server
