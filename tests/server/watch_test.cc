#include <condition_variable>
#include <latch>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/escaping.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/jobs/job_state.h"
#include "server/store/schema.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/running_server.h"
#include "tests/server/temporary_folder.h"

namespace ballpiston::server {
namespace {

using v1::EnsembleJob;
using Message = v1::WatchEnsembleJobResponse;

// So many blocks may be computed as permits are given.
class Permits {
 public:
  void Give(int count) {
    std::lock_guard lock(mutex_);
    left_ += count;
    given_.notify_all();
  }
  void Take(std::stop_token stop) {
    std::unique_lock lock(mutex_);
    if (given_.wait(lock, stop, [this] { return left_ > 0; })) --left_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable_any given_;
  int left_ = 0;
};

struct Stream {
  Stream(RunningServer& server, const std::string& name, const std::string& token = "") {
    v1::WatchEnsembleJobRequest request;
    request.set_name(name);
    request.set_resume_token(token);
    reader = server.ensemble().WatchEnsembleJob(&context, request);
  }
  std::optional<Message> Next() {
    Message message;
    if (!reader->Read(&message)) return std::nullopt;
    return message;
  }
  // Reads on until a message is like that.
  template <typename Condition>
  Message Until(Condition condition) {
    while (auto message = Next()) {
      if (condition(*message)) return *message;
    }
    ADD_FAILURE() << "the stream ended: " << reader->Finish().error_message();
    return {};
  }
  std::vector<Message> ToTheEnd() {
    std::vector<Message> messages;
    while (auto message = Next()) messages.push_back(*message);
    return messages;
  }

  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReader<Message>> reader;
};

bool HasPoints(const Message& message) { return message.snapshot().points_size() > 0; }

bool TellsFinished(const Message& message) { return message.snapshot().finished_points_size() > 0; }

// What a watch, and those that go on with its tokens, told.
class Chain {
 public:
  // Watches until a message is like that, or to the end. What was sent beyond it is lost.
  template <typename Condition>
  void Watch(RunningServer& server, const std::string& name, Condition is_enough) {
    Stream stream(server, name, token_);
    while (const auto message = stream.Next()) {
      Take(*message);
      if (!is_enough(*message)) continue;
      stream.context.TryCancel();
      stream.reader->Finish();
      return;
    }
    end_ = stream.reader->Finish();
  }
  void WatchToTheEnd(RunningServer& server, const std::string& name) {
    Watch(server, name, [](const Message&) { return false; });
  }

  // The next watch is of another life of the server: what is not stored may be lost.
  void ExpectRestart() { progress_.Clear(); }

  const std::vector<int>& finished() const { return finished_; }
  const std::string& token() const { return token_; }
  // After the last watch.
  EnsembleJob::State state() const { return state_; }
  const grpc::Status& end() const { return end_; }
  int terminal_messages() const { return terminal_messages_; }

 private:
  void Take(const Message& message) {
    EXPECT_EQ(terminal_messages_, 0) << "something came after the terminal state";
    EXPECT_FALSE(message.resume_token().empty());
    token_ = message.resume_token();
    if (message.has_job()) TakeState(message.job());
    if (!message.has_snapshot()) return;
    TakeProgress(message.snapshot().progress());
    EXPECT_LE(message.snapshot().points_size(), 100);
    EXPECT_LE(message.snapshot().finished_points_size(), 100);
    for (const auto& point : message.snapshot().finished_points()) {
      finished_.push_back(point.index());
    }
    const std::set<int> told(finished_.begin(), finished_.end());
    for (const auto& point : message.snapshot().points()) {
      EXPECT_FALSE(told.contains(point.index())) << "unfinished, and told to be finished";
    }
  }
  void TakeState(const EnsembleJob& job) {
    // In the order of their numbers; one that was overtaken is left out.
    EXPECT_GE(job.state(), state_) << StateName(state_) << " -> " << StateName(job.state());
    state_ = job.state();
    terminal_messages_ += HasEnded(state_);
    TakeProgress(job.progress());
  }
  void TakeProgress(const v1::JobProgress& progress) {
    EXPECT_GE(progress.points_done(), progress_.points_done());
    EXPECT_GE(progress.samples(), progress_.samples());
    // The store does not know what was begun of points that a cancelled job leaves unfinished.
    if (!HasEnded(state_)) {
      // Shares of points are added up as blocks come, which rounds.
      EXPECT_GE(progress.fraction(), progress_.fraction() - 1e-12);
    }
    progress_ = progress;
  }

  std::string token_;
  std::vector<int> finished_;
  v1::JobProgress progress_;
  EnsembleJob::State state_ = EnsembleJob::STATE_UNSPECIFIED;
  int terminal_messages_ = 0;
  grpc::Status end_;
};

size_t DistinctOf(const std::vector<int>& points) {
  return std::set<int>(points.begin(), points.end()).size();
}

class WatchTest : public testing::Test {
 protected:
  ~WatchTest() override { gate_.Open(); }

  RunningServer& Start(uint64_t held_from = std::numeric_limits<uint64_t>::max(),
                       std::chrono::milliseconds heartbeat = std::chrono::seconds(10)) {
    const auto hold = [this, held_from](size_t, uint64_t block, std::stop_token stop) {
      if (block >= held_from) gate_.Pass(stop);
    };
    return StartWith(Options(hold, heartbeat));
  }

  // A block for each permit. With one worker it is merged at once.
  RunningServer& StartWithPermits(int workers = 2) {
    ServerOptions options =
        Options([this](size_t, uint64_t, std::stop_token stop) { permits_.Take(stop); });
    options.workers = workers;
    return StartWith(options);
  }

  ServerOptions Options(BeforeBlock before_block = nullptr,
                        std::chrono::milliseconds heartbeat = std::chrono::seconds(10)) const {
    ServerOptions options;
    options.data_dir = folder_.File("data");
    options.workers = 2;
    options.factory = FakeExperiments(std::move(before_block));
    options.watch = {std::chrono::milliseconds(2), heartbeat};
    options.store.delay = std::chrono::milliseconds(1);
    return options;
  }

  RunningServer& StartWith(const ServerOptions& options) {
    server_.reset();  // first: one at a time
    server_.emplace(options);
    return *server_;
  }

  // Runs `sql` on the store of a server that is not running.
  void ChangeStore(const std::string& sql) {
    server_.reset();
    auto database = OpenStoreFile(folder_.File("data/store.sqlite3"));
    ASSERT_TRUE(database.ok()) << database.status();
    ASSERT_TRUE((*database)->Execute(sql).ok());
  }

  Gate gate_;
  Permits permits_;
  TemporaryFolder folder_;
  std::optional<RunningServer> server_;
};

TEST_F(WatchTest, FirstTheJobThenSnapshotsThenItsEndAndOk) {
  RunningServer& server = Start(30);
  const std::string name = server.Submit(Equilibrium(2, 100));
  Stream stream(server, name);
  const Message first = *stream.Next();
  ASSERT_TRUE(first.has_job());
  EXPECT_EQ(first.job().name(), name);
  const Message snapshot = stream.Until(HasPoints);
  EXPECT_GT(snapshot.snapshot().progress().samples(), 0);
  EXPECT_EQ(snapshot.snapshot().points(0).estimates(0).name(), "mean");
  gate_.Open();
  const std::vector<Message> rest = stream.ToTheEnd();
  EXPECT_TRUE(stream.reader->Finish().ok());
  ASSERT_FALSE(rest.empty());
  EXPECT_EQ(rest.back().job().state(), EnsembleJob::SUCCEEDED);
  for (const Message& message : rest) EXPECT_FALSE(message.resume_token().empty());
}

TEST_F(WatchTest, EveryChangeOfStateIsTold) {
  RunningServer& server = Start(3);
  const std::string name = server.Submit(Equilibrium(1, 100));
  Stream stream(server, name);
  stream.Until(
      [](const Message& message) { return message.job().state() == EnsembleJob::RUNNING; });
  ASSERT_TRUE(server.Cancel(name).ok());
  const std::vector<Message> rest = stream.ToTheEnd();
  ASSERT_FALSE(rest.empty());
  EXPECT_EQ(rest.back().job().state(), EnsembleJob::CANCELLED);
  EXPECT_TRUE(stream.reader->Finish().ok());
}

TEST_F(WatchTest, EachFinishedPointIsToldOnceInOrder) {
  constexpr int kWatches = 200;
  RunningServer& server = StartWithPermits();
  const std::string name = server.Submit(Equilibrium(2 * kWatches, 1));
  Chain chain;
  for (int i = 0; i < kWatches; ++i) {
    permits_.Give(2);
    const bool at_once = i % 3 == 0;
    chain.Watch(server, name,
                [&](const Message& message) { return at_once || TellsFinished(message); });
  }
  chain.WatchToTheEnd(server, name);
  EXPECT_TRUE(chain.end().ok());
  EXPECT_EQ(chain.state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(chain.finished().size(), 2u * kWatches);
  EXPECT_EQ(DistinctOf(chain.finished()), 2u * kWatches);
  Chain later;  // from the store
  later.WatchToTheEnd(server, name);
  EXPECT_EQ(later.finished(), chain.finished());
}

TEST_F(WatchTest, RestartsLoseAndRepeatNoFinishedPoint) {
  constexpr int kLives = 5;
  constexpr int kPointsOfALife = 150;  // more than are kept in memory
  const std::string name = StartWithPermits().Submit(Equilibrium(kLives * kPointsOfALife, 1));
  Chain chain;
  for (int life = 1; life < kLives; ++life) {
    permits_.Give(kPointsOfALife);
    chain.Watch(*server_, name, TellsFinished);
    permits_.Give(10);
    chain.Watch(*server_, name, TellsFinished);
    StartWithPermits();
    chain.ExpectRestart();
  }
  permits_.Give(kLives * kPointsOfALife);
  chain.WatchToTheEnd(*server_, name);
  EXPECT_EQ(chain.state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(chain.finished().size(), 1u * kLives * kPointsOfALife);
  EXPECT_EQ(DistinctOf(chain.finished()), 1u * kLives * kPointsOfALife);
}

TEST_F(WatchTest, StatesAndProgressNeverGoBack) {
  RunningServer& server = StartWithPermits(1);
  const std::string name = server.Submit(Equilibrium(3, 100));
  Chain chain, other;  // the other one's snapshots are shared
  for (int i = 0; i < 50; ++i) {
    permits_.Give(4);
    chain.Watch(server, name, [](const Message& message) {
      return HasPoints(message) || TellsFinished(message);
    });
    other.Watch(server, name, [](const Message& message) { return message.has_snapshot(); });
  }
  ASSERT_TRUE(server.Cancel(name).ok());
  for (Chain* watched : {&chain, &other}) {
    watched->WatchToTheEnd(server, name);
    EXPECT_EQ(watched->state(), EnsembleJob::CANCELLED);
    EXPECT_TRUE(watched->end().ok());
  }
}

// Three messages of points, and the end.
TEST_F(WatchTest, TheTerminalStateIsToldOnce) {
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(250, 1));
  server.AwaitEnd(name);
  Chain chain;
  chain.Watch(server, name, TellsFinished);
  EXPECT_EQ(chain.finished().size(), 100u);
  EXPECT_EQ(chain.terminal_messages(), 0);
  const std::string token = chain.token();
  chain.WatchToTheEnd(server, name);
  EXPECT_EQ(DistinctOf(chain.finished()), 250u);
  EXPECT_EQ(chain.terminal_messages(), 1);
  EXPECT_TRUE(chain.end().ok());
  Stream rest(server, name, token);
  EXPECT_EQ(rest.ToTheEnd().size(), 3u);
  EXPECT_TRUE(rest.reader->Finish().ok());
}

TEST_F(WatchTest, AnEndedJobOfWhichAllWasToldIsToldAtOnce) {
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(1, 5));
  Chain chain;
  chain.WatchToTheEnd(server, name);
  Stream stream(server, name, chain.token());
  const std::vector<Message> messages = stream.ToTheEnd();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].job().state(), EnsembleJob::SUCCEEDED);
  EXPECT_TRUE(stream.reader->Finish().ok());
}

TEST_F(WatchTest, AnotherJobsTokenAndNonsenseAreAsGoodAsNone) {
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(3, 1));
  const std::string other = server.Submit(Equilibrium(3, 1));
  Chain chain;
  chain.WatchToTheEnd(server, other);
  server.AwaitEnd(name);
  std::string text;
  ASSERT_TRUE(absl::WebSafeBase64Unescape(chain.token(), &text));
  std::vector<std::string> tokens = {chain.token(), "nonsense", "%", std::string(10'000, 'A')};
  const std::string id = name.substr(name.find('/') + 1);
  for (const std::string numbers : {"0:4:a:1", "0:-1:a:1", "0:1e9:a:1", "0:2:a:x", "0:2:a",
                                    ":::", "1:2:a:1", "-1:2:a:1", "x:2:a:1", "0:2:a:1:7"}) {
    tokens.push_back(absl::WebSafeBase64Escape(id + ":" + numbers));
  }
  for (const std::string& token : tokens) {
    Stream stream(server, name, token);
    EXPECT_EQ(stream.Until(TellsFinished).snapshot().finished_points_size(), 3) << token;
    stream.ToTheEnd();
    EXPECT_TRUE(stream.reader->Finish().ok());
  }
}

// Even if this engine computed it at first, and another one since.
TEST_F(WatchTest, AfterARestartForAnotherEngineAllIsToldAgain) {
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(3, 1));
  Chain chain;
  chain.WatchToTheEnd(server, name);
  EXPECT_EQ(chain.finished().size(), 3u);
  ChangeStore("UPDATE jobs SET state = 2, engine_version = '0.0.1'");  // RUNNING
  Stream stream(Start(), name, chain.token());
  std::set<int> told;
  for (const Message& message : stream.ToTheEnd()) {
    for (const auto& point : message.snapshot().finished_points()) told.insert(point.index());
  }
  EXPECT_EQ(told.size(), 3u);
}

TEST_F(WatchTest, AQuietJobHasAHeartbeat) {
  RunningServer& server = Start(0, std::chrono::milliseconds(20));
  Stream stream(server, server.Submit(Equilibrium(1, 100)));
  int beats = 0;
  stream.Until([&](const Message& message) { return message.has_heartbeat() && ++beats == 3; });
}

TEST_F(WatchTest, WithATokenOnlyWhatIsNewIsTold) {
  RunningServer& server = Start(7, std::chrono::milliseconds(20));
  const std::string name = server.Submit(Equilibrium(1, 100));
  gate_.AwaitWaiting(2);  // seven blocks are done, and no more will be
  std::string token;
  {
    Stream stream(server, name);
    // All seven blocks are told, then nothing is new.
    token = stream
                .Until([](const Message& message) {
                  return HasPoints(message) &&
                         message.snapshot().points(0).samples() == 7 * kFakeSamplesPerBlock;
                })
                .resume_token();
    stream.context.TryCancel();
  }
  Stream again(server, name, token);
  EXPECT_TRUE(again.Next()->has_job());
  again.Until([](const Message& message) {
    EXPECT_FALSE(HasPoints(message));
    return message.has_heartbeat();
  });
  Stream unknown(server, name, "b3RoZXI6MTox");  // another server's: everything
  unknown.Until(HasPoints);
}

TEST_F(WatchTest, ASlowReaderIsToldEveryFinishedPoint) {
  RunningServer& server = Start();
  // Points enough that all of them would be far more than a stalled stream takes in.
  const std::string name = server.Submit(Equilibrium(20'000, 1));
  Stream slow(server, name);
  ASSERT_TRUE(slow.Next());
  EXPECT_EQ(server.AwaitEnd(name).progress().points_done(), 20'000);  // not held up
  std::vector<int> told;
  EnsembleJob last;
  while (const auto message = slow.Next()) {
    EXPECT_LT(message->ByteSizeLong(), 1u << 20);
    for (const auto& point : message->snapshot().finished_points()) told.push_back(point.index());
    last = message->job();
  }
  EXPECT_TRUE(slow.reader->Finish().ok());
  EXPECT_EQ(told.size(), 20'000u);
  EXPECT_EQ(DistinctOf(told), 20'000u);
  EXPECT_EQ(last.state(), EnsembleJob::SUCCEEDED);
}

// What is overtaken is not told: one point of a thousand states.
TEST_F(WatchTest, ASlowReaderMissesStatesOfUnfinishedPoints) {
  RunningServer& server = Start(10'000);
  const std::string name = server.Submit(Equilibrium(1, 20'000));
  Stream slow(server, name);
  ASSERT_TRUE(slow.Next());
  gate_.AwaitWaiting(2);
  int messages = 0;
  slow.Until([&](const Message& message) {
    ++messages;
    return HasPoints(message) &&
           message.snapshot().points(0).samples() == 10'000 * kFakeSamplesPerBlock;
  });
  EXPECT_LT(messages, 10'000);
}

TEST_F(WatchTest, DroppingAWatchLeavesTheJobAlone) {
  RunningServer& server = Start(5);
  const std::string name = server.Submit(Equilibrium(1, 50));
  {
    Stream stream(server, name);
    ASSERT_TRUE(stream.Next());
    stream.context.TryCancel();
    stream.reader->Finish();
  }
  gate_.Open();
  EXPECT_EQ(server.AwaitEnd(name).state(), EnsembleJob::SUCCEEDED);
}

TEST_F(WatchTest, AStoppingServerEndsWatchesWithUnavailable) {
  RunningServer& server = Start(5);
  const std::string name = server.Submit(Equilibrium(1, 50));
  Stream stream(server, name);
  ASSERT_TRUE(stream.Next());
  std::thread stop([&] { server.server().Shutdown(std::chrono::seconds(10)); });
  stream.ToTheEnd();
  const grpc::Status status = stream.reader->Finish();
  stop.join();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(DetailsOf(status).reason, "SHUTTING_DOWN");
}

// More than may be on their way at once: who waits has its turn when those before it have read.
TEST_F(WatchTest, ReadersOfALargeJobAreToldInTurn) {
  RunningServer& server = Start(0);
  v1::EnsembleSpec large = Equilibrium(0, 1);
  for (int i = 0; i < 90'000; ++i) large.mutable_grid()->add_delta(0.1 + 1e-7 * i);
  const std::string name = server.Submit(large);
  std::vector<std::unique_ptr<Stream>> readers;  // 43 MB
  for (int i = 0; i < 60; ++i) readers.push_back(std::make_unique<Stream>(server, name));
  std::vector<std::thread> threads;
  for (const auto& reader : readers) {
    threads.emplace_back([&reader] {
      const auto first = reader->Next();
      ASSERT_TRUE(first);
      EXPECT_EQ(first->job().spec().grid().delta_size(), 90'000);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST_F(WatchTest, AReaderThatHasStalledDoesNotHoldUpAStop) {
  RunningServer& server = Start(std::numeric_limits<uint64_t>::max());
  v1::EnsembleSpec large = Equilibrium(0, 1);
  for (int i = 0; i < 90'000; ++i) large.mutable_grid()->add_delta(0.1 + 1e-7 * i);
  const std::string name = server.Submit(large);
  std::vector<std::unique_ptr<Stream>> stalled;  // nobody reads 720 kB each
  for (int i = 0; i < 50; ++i) stalled.push_back(std::make_unique<Stream>(server, name));
  const auto start = std::chrono::steady_clock::now();
  server.server().Shutdown(std::chrono::milliseconds(500));
  // The limit tells a stop from none; a busy machine may take long to write the rest.
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
}

// ---- limits ----

TEST_F(WatchTest, APrincipalsStreamsAreLimited) {
  ServerOptions options =
      Options([this](size_t, uint64_t, std::stop_token stop) { gate_.Pass(stop); });
  options.limits.max_streams_per_principal = 2;
  RunningServer& server = StartWith(options);
  const std::string name = server.Submit(Equilibrium(1, 5));
  auto first = std::make_unique<Stream>(server, name);
  Stream second(server, name);
  ASSERT_TRUE(first->Next());
  ASSERT_TRUE(second.Next());
  Stream third(server, name);
  EXPECT_FALSE(third.Next());
  const grpc::Status refused = third.reader->Finish();
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(DetailsOf(refused).reason, "TOO_MANY_STREAMS");
  EXPECT_THAT(refused.error_message(),
              testing::HasSubstr("permits 2 (--max-streams-per-principal)"));
  first->context.TryCancel();
  first.reset();
  while (!Stream(server, name).Next()) {  // until the server has heard of it
  }
}

TEST_F(WatchTest, AComparisonIsAStream) {
  ServerOptions options = Options();
  options.limits.max_streams = 1;
  options.compare = [this](const MethodComparisonSpec&, const std::stop_token& stop,
                           const auto& tell) {
    tell({.samples = 1});
    gate_.Pass(stop);
    return absl::OkStatus();
  };
  RunningServer& server = StartWith(options);
  const std::string name = server.Submit(Equilibrium(1, 5));
  grpc::ClientContext context;
  v1::CompareMethodsRequest request;
  request.set_rho(0.53);
  request.set_delta(0.1);
  request.set_epsilon(0.125);
  const auto comparison = server.method().CompareMethods(&context, request);
  v1::MethodMeasurement measurement;
  ASSERT_TRUE(comparison->Read(&measurement));
  Stream watch(server, name);
  EXPECT_FALSE(watch.Next());
  EXPECT_EQ(DetailsOf(watch.reader->Finish()).reason, "TOO_MANY_STREAMS");
  gate_.Open();
  EXPECT_FALSE(comparison->Read(&measurement));
  EXPECT_TRUE(comparison->Finish().ok());
}

class Quiet : public Watch {
 public:
  void Look(std::chrono::steady_clock::time_point) override {}
};

TEST(WatchRegistry, CountsStreamsByPrincipal) {
  Quiet a, b, c, d;
  WatchRegistry registry(std::chrono::hours(1));
  Limits limits;
  limits.max_streams = 3;
  limits.max_streams_per_principal = 2;
  EXPECT_TRUE(registry.Add(&a, "ann", limits).ok());
  EXPECT_TRUE(registry.Add(&b, "ann", limits).ok());
  EXPECT_TRUE(absl::IsResourceExhausted(registry.Add(&c, "ann", limits)));
  EXPECT_TRUE(registry.Add(&c, "bob", limits).ok());
  EXPECT_TRUE(absl::IsResourceExhausted(registry.Add(&d, "bob", limits)));
  registry.Remove(&d);  // was not taken in
  EXPECT_EQ(registry.size(), 3u);
  EXPECT_THAT(registry.StreamsByPrincipal(),
              testing::ElementsAre(testing::Pair("ann", 2), testing::Pair("bob", 1)));
  registry.Remove(&c);
  EXPECT_THAT(registry.StreamsByPrincipal(), testing::ElementsAre(testing::Pair("ann", 2)));
  limits.max_streams = limits.max_streams_per_principal = 0;  // none
  EXPECT_TRUE(registry.Add(&c, "ann", limits).ok());
  EXPECT_TRUE(registry.Add(&d, "ann", limits).ok());
}

// ---- many ----

class Listener : public grpc::ClientReadReactor<Message> {
 public:
  Listener(RunningServer& server, const std::string& name, std::latch& begun, std::latch& done)
      : begun_(begun), done_(done) {
    request_.set_name(name);
    server.ensemble().async()->WatchEnsembleJob(&context_, &request_, this);
    StartRead(&message_);
    StartCall();
  }

  void OnReadDone(bool ok) override {
    if (!ok) return;
    if (messages_++ == 0) begun_.count_down();
    finished_ += message_.snapshot().finished_points_size();
    if (message_.has_job()) state_ = message_.job().state();
    StartRead(&message_);
  }
  void OnDone(const grpc::Status& status) override {
    status_ = status;
    done_.count_down();
  }

  const grpc::Status& status() const { return status_; }
  EnsembleJob::State state() const { return state_; }
  int finished() const { return finished_; }

 private:
  std::latch& begun_;
  std::latch& done_;
  grpc::ClientContext context_;
  v1::WatchEnsembleJobRequest request_;
  Message message_;
  int messages_ = 0;
  int finished_ = 0;
  EnsembleJob::State state_ = EnsembleJob::STATE_UNSPECIFIED;
  grpc::Status status_;
};

TEST_F(WatchTest, AThousandWatchersAllSeeTheEnd) {
  constexpr int kWatchers = 1000;
  RunningServer& server = StartWithPermits();
  const std::string name = server.Submit(Equilibrium(50, 4));
  std::latch begun(kWatchers), done(kWatchers);
  std::vector<std::unique_ptr<Listener>> listeners;
  for (int i = 0; i < kWatchers; ++i) {
    listeners.push_back(std::make_unique<Listener>(server, name, begun, done));
  }
  begun.wait();
  permits_.Give(200);
  done.wait();
  for (const auto& listener : listeners) {
    EXPECT_TRUE(listener->status().ok()) << listener->status().error_message();
    EXPECT_EQ(listener->state(), EnsembleJob::SUCCEEDED);
    EXPECT_EQ(listener->finished(), 50);
  }
}

}  // namespace
}  // namespace ballpiston::server
