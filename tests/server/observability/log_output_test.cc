// A log whose reader is slow or does not read.
#include "server/observability/log_output.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace ballpiston::server {
namespace {

std::string Loss(int64_t lost) { return absl::StrCat(lost, " lost\n"); }

class LogOutputTest : public testing::Test {
 protected:
  explicit LogOutputTest(bool is_socket = false) {
    int ends[2];
    EXPECT_EQ(is_socket ? socketpair(AF_UNIX, SOCK_STREAM, 0, ends) : pipe(ends), 0);
    reader_ = ends[0];
    writer_ = ends[1];
    fcntl(reader_, F_SETFL, O_NONBLOCK);
  }
  ~LogOutputTest() override {
    close(reader_);
    close(writer_);
  }

  // So many bytes, or all that there are.
  std::string Read(size_t size = std::string::npos) {
    std::string text;
    char buffer[4096];
    while (text.size() < size) {
      const ssize_t n = read(reader_, buffer, std::min(sizeof(buffer), size - text.size()));
      if (n <= 0) break;
      text.append(buffer, static_cast<size_t>(n));
    }
    return text;
  }

  int reader_ = -1;
  int writer_ = -1;
};

class LogSocketTest : public LogOutputTest {
 protected:
  LogSocketTest() : LogOutputTest(true) {}
};

TEST_F(LogOutputTest, LinesArriveUnchanged) {
  LogOutput output(writer_);
  for (int i = 0; i < 3; ++i) output.Write(absl::StrCat("line ", i, "\n"), Loss);
  EXPECT_EQ(Read(), "line 0\nline 1\nline 2\n");
}

// A write that waited for the reader would wait for ever.
TEST_F(LogOutputTest, UnreadLinesAreCounted) {
  LogOutput output(writer_);
  const std::string line = std::string(1023, 'x') + "\n";
  constexpr int kLines = 10'000;
  for (int i = 0; i < kLines; ++i) output.Write(line, Loss);
  const size_t taken = Read().size() / line.size();
  EXPECT_GT(taken, 0u);
  EXPECT_LT(taken, size_t{kLines});
  output.Write("next\n", Loss);
  EXPECT_EQ(Read(), absl::StrCat(kLines - taken, " lost\nnext\n"));
}

TEST_F(LogSocketTest, AnIncompleteLineGetsItsNewline) {
  const int size = 4096;
  ASSERT_EQ(setsockopt(writer_, SOL_SOCKET, SO_SNDBUF, &size, sizeof(size)), 0);
  LogOutput output(writer_);
  constexpr int kLines = 1000;
  for (int i = 0; i < kLines; ++i) output.Write(std::string(3999, 'x') + "\n", Loss);
  const std::string before = Read();
  output.Write("next\n", Loss);
  const std::string after = Read();
  EXPECT_THAT(after, testing::EndsWith(" lost\nnext\n"));
  // Only the last line may be incomplete; then a newline follows it.
  EXPECT_EQ(before.size() % 4000 == 0, after[0] != '\n');
}

TEST_F(LogOutputTest, LinesToAClosedDescriptorAreCounted) {
  const auto handler = signal(SIGPIPE, SIG_IGN);  // as the program does
  const absl::Cleanup restore = [handler] { signal(SIGPIPE, handler); };
  close(std::exchange(reader_, -1));
  for (const int descriptor : {writer_, -1}) {
    LogOutput closed(descriptor);
    int64_t counted = 0;
    for (int i = 0; i < 3; ++i) {
      closed.Write("line\n", [&](int64_t lost) {
        counted = lost;
        return Loss(lost);
      });
    }
    EXPECT_EQ(counted, 2);  // before the third
  }
}

}  // namespace
}  // namespace ballpiston::server
