#include "server/rpc/builtin_streams.h"

#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

size_t ThreadsOfThisProcess() { return NamesIn("/proc/self/task").size(); }

TEST(BuiltinStreams, ReflectionStreamsUseLimitedThreadsAndOtherCallsGoOn) {
  RunningServer server;
  ASSERT_OK(CallByName(server.channel(), kReflection, kListServices));
  const size_t before = ThreadsOfThisProcess();
  std::vector<std::unique_ptr<NamedCall>> streams;
  for (int i = 0; i < 2 * kReflectionStreams; ++i) {
    streams.push_back(std::make_unique<NamedCall>(server.channel(), kReflection));
  }
  // The server rejects the last stream. Without the limit it would stay open.
  EXPECT_THAT(streams.back()->Finish(), StatusIs(grpc::StatusCode::RESOURCE_EXHAUSTED));
  EXPECT_LT(ThreadsOfThisProcess(), before + 50);  // the client's own may be among them
  EXPECT_OK(CallByName(server.channel(), kListJobs));
  EXPECT_OK(CallByName(server.channel(), kCheckHealth));
  streams.clear();
  AwaitThat([&server] { return CallByName(server.channel(), kReflection, kListServices).ok(); });
}

TEST(BuiltinStreams, HealthWatchesAreLimited) {
  RunningServer server;
  std::vector<std::unique_ptr<NamedCall>> watches;
  const auto watch = [&] {
    watches.push_back(std::make_unique<NamedCall>(server.channel(), kWatchHealth));
    watches.back()->Send(kWholeServer);
    return watches.back()->Read().has_value();
  };
  for (int i = 0; i < kHealthWatches; ++i) ASSERT_TRUE(watch()) << i;
  ASSERT_FALSE(watch());
  EXPECT_THAT(watches.back()->Finish(), StatusIs(grpc::StatusCode::RESOURCE_EXHAUSTED));
  EXPECT_OK(CallByName(server.channel(), kCheckHealth));
  watches.clear();
  AwaitThat(watch);
}

}  // namespace
}  // namespace ballpiston::server
