// What one Create comes to: a new job, an earlier one, or a refusal. At the book of jobs, where
// principals are; what the API adds is at the end.
#include "server/jobs/acceptance.h"

#include <condition_variable>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/cord.h"
#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "google/rpc/error_details.pb.h"
#include "gtest/gtest.h"
#include "server/jobs/job_book.h"
#include "server/jobs/job_state.h"
#include "server/jobs/question.h"
#include "server/store/job_table.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/running_server.h"
#include "tests/server/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using v1::EnsembleJob;

constexpr char kUuid[] = "123e4567-e89b-12d3-a456-426614174000";
constexpr uint64_t kFailingSeed = 13;
constexpr uint64_t kHeldSeed = 14;

const Principal kAnn{"ann", Role::kSubmit};
const Principal kBob{"bob", Role::kSubmit};

v1::CreateEnsembleJobRequest Asking(const v1::EnsembleSpec& spec, const char* request_id = "") {
  v1::CreateEnsembleJobRequest request;
  *request.mutable_spec() = spec;
  request.set_request_id(request_id);
  return request;
}

v1::CreateEnsembleJobRequest AskingAnew(const v1::EnsembleSpec& spec, const char* request_id = "") {
  v1::CreateEnsembleJobRequest request = Asking(spec, request_id);
  request.set_fresh(true);
  return request;
}

v1::EnsembleSpec Question(uint64_t seed = 1) {
  v1::EnsembleSpec spec = Equilibrium(2, 5);
  spec.set_seed(seed);
  return spec;
}

google::rpc::ErrorInfo InfoOf(const absl::Status& status) {
  google::rpc::ErrorInfo info;
  const auto payload = status.GetPayload("type.googleapis.com/google.rpc.ErrorInfo");
  if (payload) info.ParseFromString(std::string(*payload));
  return info;
}

std::string ReasonOf(const absl::Status& status) { return InfoOf(status).reason(); }

// Jobs with the seeds above fail, or wait at the gate.
class AcceptanceTest : public testing::Test {
 protected:
  AcceptanceTest() { Start(); }
  ~AcceptanceTest() override { Stop(); }

  void Start() {
    auto store = Store::Open(folder_.File("store"), {.delay = std::chrono::milliseconds(1)});
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
    book_ = std::make_unique<JobBook>(*store_, limits_, 2, Experiments(), [this] {
      std::lock_guard lock(mutex_);
      changed_.notify_all();
    });
    ASSERT_TRUE(book_->Resume().ok());
  }

  void Stop() {
    book_.reset();
    store_.reset();
  }

  void StartAgain() {
    Stop();
    Start();
  }

  ExperimentFactory Experiments() {
    return [this](const EnsembleSpec& spec, size_t index, const std::stop_token& told) {
      return FakeExperiments([this, seed = spec.seed](size_t, uint64_t, std::stop_token stop) {
        if (seed == kFailingSeed) throw std::runtime_error("the ball left the cell");
        if (seed == kHeldSeed) gate_.Pass(stop);
      })(spec, index, told);
    };
  }

  absl::StatusOr<EnsembleJob> Create(const Principal& caller,
                                     const v1::CreateEnsembleJobRequest& request) {
    const CheckedSpec checked = CheckSpec(request.spec());
    EXPECT_TRUE(checked.violations.empty()) << checked.violations[0].description;
    return book_->Create(caller, request, checked);
  }

  // The name of a job that has to be made, or answered with.
  std::string Name(const Principal& caller, const v1::CreateEnsembleJobRequest& request) {
    const auto job = Create(caller, request);
    EXPECT_TRUE(job.ok()) << job.status();
    return job.ok() ? job->name() : "";
  }

  std::string IdOf(const std::string& name) const { return name.substr(name.find('/') + 1); }

  EnsembleJob AwaitEnd(const std::string& name) {
    absl::StatusOr<EnsembleJob> job;
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] {
      job = book_->Get({"", Role::kAdmin}, IdOf(name));
      return !job.ok() || HasEnded(job->state());
    });
    EXPECT_TRUE(job.ok()) << job.status();
    return job.ok() ? *std::move(job) : EnsembleJob();
  }

  // A job that SUCCEEDED in answering.
  std::string Answered(const Principal& caller, const v1::CreateEnsembleJobRequest& request) {
    const std::string name = Name(caller, request);
    EXPECT_EQ(AwaitEnd(name).state(), EnsembleJob::SUCCEEDED);
    return name;
  }

  // That the request made a job of its own.
  void ExpectComputed(const Principal& caller, const v1::CreateEnsembleJobRequest& request,
                      const std::string& earlier) {
    const auto job = Create(caller, request);
    ASSERT_TRUE(job.ok()) << job.status();
    EXPECT_NE(job->name(), earlier);
    EXPECT_FALSE(job->answered_from_store());
  }

  size_t Jobs() {
    const auto page =
        book_->List({"", Role::kAdmin}, {.before = std::numeric_limits<int64_t>::max(),
                                         .max_jobs = 1000,
                                         .max_bytes = std::numeric_limits<size_t>::max()});
    EXPECT_TRUE(page.ok()) << page.status();
    return page.ok() ? page->jobs.size() : 0;
  }

  Limits limits_;
  Gate gate_;
  TemporaryFolder folder_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::unique_ptr<Store> store_;
  std::unique_ptr<JobBook> book_;
};

// ---- the same question ----

TEST_F(AcceptanceTest, TheSameQuestionIsAnsweredByTheJobThatSucceeded) {
  const std::string first = Answered(kAnn, Asking(Question()));
  const auto again = Create(kAnn, Asking(Question()));
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->name(), first);
  EXPECT_EQ(again->state(), EnsembleJob::SUCCEEDED);
  EXPECT_TRUE(again->answered_from_store());
  EXPECT_EQ(Jobs(), 1u);
  // Nobody but who asked is told so.
  EXPECT_FALSE(book_->Get(kAnn, IdOf(first))->answered_from_store());
  StartAgain();
  EXPECT_TRUE(Create(kAnn, Asking(Question()))->answered_from_store());
}

TEST_F(AcceptanceTest, APriorityIsNoPartOfTheQuestion) {
  const std::string first = Answered(kAnn, Asking(Question()));
  v1::CreateEnsembleJobRequest urgent = Asking(Question());
  urgent.set_priority(100);
  EXPECT_EQ(Name(kAnn, urgent), first);
}

TEST_F(AcceptanceTest, AFreshAnswerIsComputed) {
  const std::string first = Answered(kAnn, Asking(Question()));
  ExpectComputed(kAnn, AskingAnew(Question()), first);
}

TEST_F(AcceptanceTest, ABudgetsAnswerIsComputed) {
  v1::EnsembleSpec spec = Question();
  spec.mutable_target()->Clear();
  spec.mutable_target()->mutable_budget()->set_nanos(1);
  const std::string first = Answered(kAnn, Asking(spec));
  ExpectComputed(kAnn, Asking(spec), first);
}

TEST_F(AcceptanceTest, AnotherQuestionIsComputed) {
  const std::string first = Answered(kAnn, Asking(Question()));
  std::vector<v1::EnsembleSpec> others(5, Question());
  others[0].set_seed(2);
  others[1].set_model(v1::EnsembleSpec::BILLIARD);
  others[2].set_precision(v1::EnsembleSpec::SINGLE);
  others[3].set_verify(true);
  others[4].mutable_target()->set_collisions(6);
  for (const v1::EnsembleSpec& other : others) ExpectComputed(kAnn, Asking(other), first);
}

TEST_F(AcceptanceTest, AnotherPrincipalsAnswerIsNotGiven) {
  const std::string first = Answered(kAnn, Asking(Question()));
  ExpectComputed(kBob, Asking(Question()), first);
  // An administrator sees it, but did not ask it.
  ExpectComputed({"root", Role::kAdmin}, Asking(Question()), first);
}

TEST_F(AcceptanceTest, AJobThatFailedAnswersNothing) {
  const std::string failed = Name(kAnn, Asking(Question(kFailingSeed)));
  EXPECT_EQ(AwaitEnd(failed).state(), EnsembleJob::FAILED);
  ExpectComputed(kAnn, Asking(Question(kFailingSeed)), failed);
}

TEST_F(AcceptanceTest, AnActiveOrCancelledJobAnswersNothing) {
  const std::string held = Name(kAnn, Asking(Question(kHeldSeed)));
  gate_.AwaitWaiting(1);
  const auto second = Create(kAnn, Asking(Question(kHeldSeed)));
  ASSERT_TRUE(second.ok());
  EXPECT_NE(second->name(), held);
  for (const std::string& name : {held, second->name()}) {
    ASSERT_TRUE(book_->Cancel(kAnn, IdOf(name), "").ok());
  }
  EXPECT_EQ(AwaitEnd(held).state(), EnsembleJob::CANCELLED);
  ExpectComputed(kAnn, Asking(Question(kHeldSeed)), held);
}

// A row as this or an earlier engine left it.
JobRecord AnnsJob(const std::string& id, const std::string& engine_version) {
  JobRecord record;
  record.id = id;
  record.principal = kAnn.name;
  record.spec = SpecBytes(Question());
  record.engine_version = engine_version;
  record.question = QuestionOf(Question(), engine_version);
  record.create_time = absl::Now();
  record.points = 2;
  return record;
}

TEST_F(AcceptanceTest, AnotherEnginesAnswerIsNotGiven) {
  const auto insert_succeeded = [&](JobRecord record) {
    const auto insert = [&](Database& database) {
      const absl::Status inserted = InsertJob(database, record);
      if (!inserted.ok()) return inserted;
      JobEnd end;
      end.time = absl::Now();
      return EndJob(database, record.sequence, end).status();
    };
    ASSERT_TRUE(store_->Commit(insert).ok());
  };
  insert_succeeded(AnnsJob("of-another-engine", "0.0.1"));
  const std::string computed = Answered(kAnn, Asking(Question()));
  EXPECT_NE(computed, "ensembleJobs/of-another-engine");
  ASSERT_TRUE(book_->Delete(kAnn, IdOf(computed)).ok());
  insert_succeeded(AnnsJob("of-this-engine", EngineVersion()));
  EXPECT_EQ(Name(kAnn, Asking(Question())), "ensembleJobs/of-this-engine");
}

TEST_F(AcceptanceTest, AJobThatThisEngineComputedAnewAnswers) {
  JobRecord record = AnnsJob("unfinished", "0.0.1");
  ASSERT_TRUE(store_->Commit([&](Database& database) { return InsertJob(database, record); }).ok());
  StartAgain();
  EXPECT_EQ(AwaitEnd("ensembleJobs/unfinished").state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(Name(kAnn, Asking(Question())), "ensembleJobs/unfinished");
}

// ---- which questions are the same ----

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

void SetOther(Message& message, const FieldDescriptor& field) {
  const google::protobuf::Reflection& reflect = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return field.is_repeated() ? reflect.AddDouble(&message, &field, 0.0625)
                                 : reflect.SetDouble(&message, &field, 0.0625);
    case FieldDescriptor::CPPTYPE_INT32:
      return field.is_repeated() ? reflect.AddInt32(&message, &field, 77)
                                 : reflect.SetInt32(&message, &field, 77);
    case FieldDescriptor::CPPTYPE_INT64:
      return reflect.SetInt64(&message, &field, 77);
    case FieldDescriptor::CPPTYPE_UINT64:
      return reflect.SetUInt64(&message, &field, 77);
    case FieldDescriptor::CPPTYPE_BOOL:
      return reflect.SetBool(&message, &field, !reflect.GetBool(message, &field));
    case FieldDescriptor::CPPTYPE_ENUM:
      return reflect.SetEnumValue(&message, &field, field.enum_type()->value_count() - 1);
    default:
      ADD_FAILURE() << field.full_name() << " is of a kind that this test does not know";
  }
}

// Calls `visit` with a copy of `whole` for each field of it, and of what it holds, in which that
// field alone is another one.
void WithEachFieldChanged(
    const v1::EnsembleSpec& whole, const std::vector<int>& path,
    const google::protobuf::Descriptor& type,
    const std::function<void(const FieldDescriptor&, const v1::EnsembleSpec&)>& visit) {
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    std::vector<int> below = path;
    below.push_back(field.number());
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      WithEachFieldChanged(whole, below, *field.message_type(), visit);
      continue;
    }
    v1::EnsembleSpec changed = whole;
    Message* holder = &changed;
    for (const int number : path) {
      holder = holder->GetReflection()->MutableMessage(
          holder, holder->GetDescriptor()->FindFieldByNumber(number));
    }
    SetOther(*holder, field);
    visit(field, changed);
  }
}

TEST(Question, EveryFieldOfTheSpecificationMakesItAnother) {
  std::map<std::string, std::string> fields = {{QuestionOf(Question(), "1"), "none"}};
  int changes = 0;
  WithEachFieldChanged(Question(), {}, *v1::EnsembleSpec::descriptor(),
                       [&](const FieldDescriptor& field, const v1::EnsembleSpec& changed) {
                         ++changes;
                         const std::string question = QuestionOf(changed, "1");
                         if (changed.target().has_budget()) {
                           EXPECT_EQ(question, "") << field.full_name();  // that is nobody's
                           return;
                         }
                         EXPECT_NE(question, "");
                         const auto [same, is_new] = fields.emplace(question, field.full_name());
                         EXPECT_TRUE(is_new)
                             << field.full_name() << " makes the same question as " << same->second;
                       });
  EXPECT_GE(changes, 15);
}

TEST(Question, TheEngineIsAPartOfIt) {
  EXPECT_NE(QuestionOf(Question(), "1"), QuestionOf(Question(), "2"));
  EXPECT_EQ(QuestionOf(Question(), "1"), QuestionOf(Question(), "1"));
}

TEST(Payload, EveryFieldOfTheRequestButItsIdIsAPartOfIt) {
  const v1::CreateEnsembleJobRequest request = Asking(Question(), kUuid);
  std::map<std::string, std::string> fields = {{PayloadOf(request), "none"}};
  const auto expect_new = [&](const FieldDescriptor& field,
                              const v1::CreateEnsembleJobRequest& changed) {
    const auto [same, is_new] = fields.emplace(PayloadOf(changed), field.full_name());
    EXPECT_TRUE(is_new) << field.full_name() << " makes the same payload as " << same->second;
  };
  const google::protobuf::Descriptor& type = *v1::CreateEnsembleJobRequest::descriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    // validate_only makes nothing that a payload could be of.
    if (field.name() == "spec" || field.name() == "request_id" || field.name() == "validate_only") {
      continue;
    }
    v1::CreateEnsembleJobRequest changed = request;
    SetOther(changed, field);
    expect_new(field, changed);
  }
  WithEachFieldChanged(Question(), {}, *v1::EnsembleSpec::descriptor(),
                       [&](const FieldDescriptor& field, const v1::EnsembleSpec& spec) {
                         expect_new(field, Asking(spec, kUuid));
                       });
  EXPECT_EQ(PayloadOf(Asking(Question(), "another")), PayloadOf(request));
}

// ---- the same request ----

TEST_F(AcceptanceTest, SixtyFourRequestsAtOnceWithOneIdMakeOneJob) {
  std::mutex mutex;
  std::set<std::string> names;
  std::vector<std::thread> threads;
  for (int i = 0; i < 64; ++i) {
    threads.emplace_back([&] {
      const std::string name = Name(kAnn, AskingAnew(Question(), kUuid));
      std::lock_guard lock(mutex);
      names.insert(name);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(names.size(), 1u);
  EXPECT_EQ(Jobs(), 1u);
}

TEST_F(AcceptanceTest, AReplayIsTheSameJobAfterARestart) {
  const std::string held = Name(kAnn, AskingAnew(Question(kHeldSeed), kUuid));
  StartAgain();
  const auto active = Create(kAnn, AskingAnew(Question(kHeldSeed), kUuid));
  ASSERT_TRUE(active.ok()) << active.status();
  EXPECT_EQ(active->name(), held);
  EXPECT_FALSE(active->answered_from_store());
  gate_.Open();
  EXPECT_EQ(AwaitEnd(held).state(), EnsembleJob::SUCCEEDED);
  StartAgain();
  const auto ended = Create(kAnn, AskingAnew(Question(kHeldSeed), kUuid));
  EXPECT_EQ(ended->name(), held);
  EXPECT_FALSE(ended->answered_from_store());
  EXPECT_EQ(Jobs(), 1u);
}

// What was said the first time is said again.
TEST_F(AcceptanceTest, AReplayOfARequestAnsweredFromTheStoreIsAnsweredTheSame) {
  const std::string first = Answered(kAnn, Asking(Question()));
  for (int i = 0; i < 2; ++i) {
    const auto answer = Create(kAnn, Asking(Question(), kUuid));
    EXPECT_EQ(answer->name(), first);
    EXPECT_TRUE(answer->answered_from_store());
    StartAgain();
  }
}

TEST_F(AcceptanceTest, AnIdIsNotForAnotherRequest) {
  const std::string first = Name(kAnn, Asking(Question(), kUuid));
  std::vector<v1::CreateEnsembleJobRequest> others(3, Asking(Question(), kUuid));
  others[0].mutable_spec()->set_seed(2);
  others[1].set_fresh(true);
  others[2].set_priority(1);
  for (int restarted = 0; restarted < 2; ++restarted) {
    for (const v1::CreateEnsembleJobRequest& other : others) {
      const absl::Status refused = Create(kAnn, other).status();
      EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
      EXPECT_EQ(ReasonOf(refused), "REQUEST_ID_REUSED");
    }
    EXPECT_EQ(Name(kAnn, Asking(Question(), kUuid)), first);
    StartAgain();
  }
  EXPECT_EQ(Jobs(), 1u);
}

TEST_F(AcceptanceTest, OneIdOfTwoPrincipalsMakesTwoJobs) {
  const std::string anns = Name(kAnn, Asking(Question(), kUuid));
  const std::string bobs = Name(kBob, Asking(Question(2), kUuid));
  EXPECT_NE(anns, bobs);
  EXPECT_EQ(Name(kAnn, Asking(Question(), kUuid)), anns);
  EXPECT_EQ(Name(kBob, Asking(Question(2), kUuid)), bobs);
  EXPECT_TRUE(absl::IsNotFound(book_->Get(kAnn, IdOf(bobs)).status()));
}

// ---- limits ----

class LimitTest : public AcceptanceTest {
 protected:
  void Limit(const Limits& limits) {
    limits_ = limits;
    StartAgain();
  }

  // Keeps the workers busy, so that the job and those after it stay active.
  std::string Hold(const Principal& caller, const char* request_id = "") {
    return Name(caller, AskingAnew(Question(kHeldSeed), request_id));
  }

  void ExpectRefused(const absl::Status& refused, const std::string& reason,
                     const std::string& flag, const std::string& limit) {
    EXPECT_TRUE(absl::IsResourceExhausted(refused)) << refused;
    const google::rpc::ErrorInfo info = InfoOf(refused);
    EXPECT_EQ(info.domain(), "ballpiston");
    EXPECT_EQ(info.reason(), reason);
    EXPECT_EQ(info.metadata().at("flag"), flag);
    EXPECT_EQ(info.metadata().at("limit"), limit);
    EXPECT_THAT(std::string(refused.message()), HasSubstr("--" + flag));
  }
};

TEST_F(LimitTest, AFullQueueRefusesWhatIsNewAndNothingElse) {
  const std::string answered = Answered(kAnn, Asking(Question()));
  Limit({.max_active_jobs = 2});
  const std::string first = Hold(kAnn, kUuid);
  Hold(kBob);
  for (const Principal& caller : {kAnn, kBob}) {
    ExpectRefused(Create(caller, Asking(Question(2))).status(), "QUEUE_FULL", "max-active-jobs",
                  "2");
  }
  // A replay, and what the store can answer.
  EXPECT_EQ(Name(kAnn, AskingAnew(Question(kHeldSeed), kUuid)), first);
  EXPECT_EQ(Name(kAnn, Asking(Question())), answered);
  // And with another request its id is refused for what it is.
  EXPECT_EQ(ReasonOf(Create(kAnn, Asking(Question(3), kUuid)).status()), "REQUEST_ID_REUSED");
  EXPECT_EQ(Jobs(), 3u);
  ASSERT_TRUE(book_->Cancel(kAnn, IdOf(first), "").ok());
  AwaitEnd(first);
  EXPECT_TRUE(Create(kAnn, Asking(Question(2))).ok());
}

TEST_F(LimitTest, APrincipalsJobsAreItsOwn) {
  Limit({.max_active_jobs_per_principal = 1});
  Hold(kAnn);
  ExpectRefused(Create(kAnn, Asking(Question())).status(), "TOO_MANY_JOBS",
                "max-active-jobs-per-principal", "1");
  EXPECT_TRUE(Create(kBob, Asking(Question())).ok());
}

// The id is free: nothing was made with it.
TEST_F(LimitTest, ARefusedRequestMayComeAgain) {
  Limit({.max_active_jobs = 1});
  const std::string first = Hold(kAnn);
  EXPECT_EQ(ReasonOf(Create(kAnn, Asking(Question(), kUuid)).status()), "QUEUE_FULL");
  ASSERT_TRUE(book_->Cancel(kAnn, IdOf(first), "").ok());
  AwaitEnd(first);
  EXPECT_TRUE(Create(kAnn, Asking(Question(), kUuid)).ok());
}

TEST_F(LimitTest, AJobMayNotHaveTooManyPoints) {
  Limit({.max_points_per_job = 3});
  EXPECT_TRUE(Create(kAnn, Asking(Equilibrium(3, 5))).ok());
  ExpectRefused(Create(kAnn, Asking(Equilibrium(4, 5))).status(), "TOO_MANY_POINTS",
                "max-points-per-job", "3");
}

TEST_F(LimitTest, AJobMayNotTakeTooManySamples) {
  Limit({.max_samples_per_job = 40'000});
  EXPECT_TRUE(Create(kAnn, Asking(Equilibrium(4, 10'000))).ok());
  ExpectRefused(Create(kAnn, Asking(Equilibrium(4, 10'001))).status(), "TOO_MANY_SAMPLES",
                "max-samples-per-job", "40000");
  v1::EnsembleSpec by_default = Equilibrium(5, 1);
  by_default.clear_target();
  EXPECT_EQ(ReasonOf(Create(kAnn, Asking(by_default)).status()), "TOO_MANY_SAMPLES");
  // How many these take is not known before.
  v1::EnsembleSpec tolerance = Equilibrium(5, 1);
  tolerance.mutable_target()->set_tolerance(0.1);
  EXPECT_TRUE(Create(kAnn, Asking(tolerance)).ok());
}

TEST_F(LimitTest, ThePointsOfActiveJobsAreLimited) {
  Limit({.max_active_points = 20, .max_active_points_per_principal = 6});
  const auto held = [](int points, const char* request_id = "") {
    v1::EnsembleSpec spec = Equilibrium(points, 5);
    spec.set_seed(kHeldSeed);
    return AskingAnew(spec, request_id);
  };
  const std::string first = Name(kAnn, held(4, kUuid));
  const auto expect_full = [&] {
    ExpectRefused(Create(kAnn, held(3)).status(), "TOO_MANY_ACTIVE_POINTS",
                  "max-active-points-per-principal", "6");
  };
  expect_full();
  Name(kBob, held(6));
  Name({"eve", Role::kSubmit}, held(6));
  ExpectRefused(Create({"zoe", Role::kSubmit}, held(5)).status(), "TOO_MANY_ACTIVE_POINTS",
                "max-active-points", "20");
  EXPECT_EQ(Name(kAnn, held(4, kUuid)), first);  // a replay
  StartAgain();
  expect_full();
  ASSERT_TRUE(book_->Cancel(kAnn, IdOf(first), "").ok());
  AwaitEnd(first);
  EXPECT_TRUE(Create(kAnn, held(3)).ok());
}

// What is not made takes no room.
TEST_F(LimitTest, PointsOfAJobThatIsNotKeptDoNotCount) {
  Limit({.max_active_points = 4, .max_active_points_per_principal = 0});
  const std::string answered = Answered(kAnn, Asking(Equilibrium(3, 5)));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(Name(kAnn, Asking(Equilibrium(3, 5))), answered);
    EXPECT_EQ(ReasonOf(Create(kAnn, Asking(Equilibrium(5, 5))).status()), "TOO_MANY_ACTIVE_POINTS");
  }
  AwaitEnd(Name(kAnn, AskingAnew(Equilibrium(4, 5))));
}

TEST(ActivePointsTest, AJobCountsOnce) {
  ActivePoints points;
  for (int i = 0; i < 3; ++i) points.Add("a", "ann", 4);
  const Limits limits = {.max_active_points = 5};
  EXPECT_TRUE(points.Check("ann", 1, limits).ok());
  EXPECT_FALSE(points.Check("bob", 2, limits).ok());
  for (int i = 0; i < 2; ++i) points.Remove("a");
  EXPECT_TRUE(points.Check("ann", 5, limits).ok());
  EXPECT_FALSE(points.Check("ann", 6, limits).ok());
}

// Of the requests that one job answers a thousand are remembered; the answer is the same.
TEST_F(AcceptanceTest, RequestsThatOneJobAnswersAreNotRememberedWithoutEnd) {
  const std::string name = Answered(kAnn, Asking(Question()));
  const auto requests = [&] {
    int64_t found = 0;
    EXPECT_TRUE(store_
                    ->Read([&](Database& database) {
                      const auto count = CountRequests(database, 1, 1'000'000);
                      found = count.value_or(-1);
                      return count.status();
                    })
                    .ok());
    return found;
  };
  ASSERT_TRUE(store_
                  ->Commit([](Database& database) {
                    absl::Status inserted;
                    for (int i = 0; i < 999 && inserted.ok(); ++i) {
                      inserted = InsertRequest(database, {kAnn.name, std::to_string(i), "", 1});
                    }
                    return inserted;
                  })
                  .ok());
  EXPECT_EQ(requests(), 999);
  for (int i = 0; i < 3; ++i) {
    const std::string id = "123e4567-e89b-12d3-a456-42661417400" + std::to_string(i);
    for (int repeated = 0; repeated < 2; ++repeated) {
      const auto again = Create(kAnn, Asking(Question(), id.c_str()));
      ASSERT_TRUE(again.ok()) << again.status();
      EXPECT_EQ(again->name(), name);
      EXPECT_TRUE(again->answered_from_store());
    }
  }
  EXPECT_EQ(requests(), 1000);
}

TEST_F(LimitTest, AReplayAndAnAnswerAreGivenUnderALowerLimit) {
  const std::string name = Answered(kAnn, Asking(Equilibrium(4, 5), kUuid));
  Limit({.max_points_per_job = 3});
  EXPECT_EQ(Name(kAnn, Asking(Equilibrium(4, 5), kUuid)), name);
  EXPECT_EQ(Name(kAnn, Asking(Equilibrium(4, 5))), name);
  EXPECT_EQ(ReasonOf(Create(kAnn, AskingAnew(Equilibrium(4, 5))).status()), "TOO_MANY_POINTS");
}

TEST_F(LimitTest, ZeroIsNoLimit) {
  Limit({.max_active_jobs = 0,
         .max_active_jobs_per_principal = 0,
         .max_active_points = 0,
         .max_active_points_per_principal = 0,
         .max_points_per_job = 0,
         .max_samples_per_job = 0});
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(Create(kAnn, AskingAnew(Equilibrium(50, 1000))).ok());
}

// ---- through the API ----

class AcceptanceRpcTest : public testing::Test {
 protected:
  RunningServer& Start(const Limits& limits) {
    ServerOptions options;
    options.data_dir = folder_.File("data");
    options.factory = FakeExperiments();
    options.limits = limits;
    server_.emplace(options);
    return *server_;
  }

  int Jobs() {
    grpc::ClientContext context;
    v1::ListEnsembleJobsResponse list;
    EXPECT_TRUE(server_->ensemble().ListEnsembleJobs(&context, {}, &list).ok());
    return list.jobs_size();
  }

  TemporaryFolder folder_;
  std::optional<RunningServer> server_;
};

TEST_F(AcceptanceRpcTest, APriorityOutOfRangeIsAViolation) {
  RunningServer& server = Start({});
  for (const int priority : {-101, 101, std::numeric_limits<int32_t>::min()}) {
    v1::CreateEnsembleJobRequest request = Asking(Question());
    request.set_priority(priority);
    EnsembleJob job;
    const grpc::Status status = server.Create(request, &job);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(DetailsOf(status).fields, ElementsAre("priority"));
    EXPECT_THAT(status.error_message(), HasSubstr("-100 to 100"));
  }
  for (const int priority : {-100, 100}) {
    v1::CreateEnsembleJobRequest request = AskingAnew(Question());
    request.set_priority(priority);
    EnsembleJob job;
    EXPECT_TRUE(server.Create(request, &job).ok());
    EXPECT_EQ(job.priority(), priority);
    EXPECT_EQ(job.principal(), "local");
  }
  EXPECT_EQ(Jobs(), 2);
}

TEST_F(AcceptanceRpcTest, ValidateOnlyTellsLimitsAndMakesNothing) {
  RunningServer& server = Start({.max_points_per_job = 3, .max_samples_per_job = 100});
  const std::pair<v1::EnsembleSpec, const char*> questions[] = {
      {Equilibrium(4, 1), "TOO_MANY_POINTS"},
      {Equilibrium(3, 40), "TOO_MANY_SAMPLES"},
      {Equilibrium(3, 30), ""}};
  for (const auto& [spec, reason] : questions) {
    v1::CreateEnsembleJobRequest request = Asking(spec, kUuid);
    request.set_validate_only(true);
    EnsembleJob job;
    const grpc::Status status = server.Create(request, &job);
    EXPECT_EQ(DetailsOf(status).reason, reason);
    EXPECT_EQ(status.error_code(),
              *reason == '\0' ? grpc::StatusCode::OK : grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_EQ(job.name(), "");
    EXPECT_FALSE(job.answered_from_store());
  }
  EXPECT_EQ(Jobs(), 0);
}

TEST_F(AcceptanceRpcTest, ValidateOnlyAnswersAsOtherwise) {
  RunningServer& server = Start({.max_active_jobs = 1});
  const std::string answered = server.Submit(Question());
  server.AwaitEnd(answered);
  v1::CreateEnsembleJobRequest request = Asking(Question(), kUuid);
  request.set_validate_only(true);
  EnsembleJob job;
  ASSERT_TRUE(server.Create(request, &job).ok());
  EXPECT_EQ(job.name(), answered);
  EXPECT_TRUE(job.answered_from_store());
  EXPECT_EQ(Jobs(), 1);
  // Nothing was kept of the id: it is free for another question.
  ASSERT_TRUE(server.Create(Asking(Question(2), kUuid), &job).ok());
  EXPECT_NE(job.name(), answered);
  server.AwaitEnd(job.name());
}

}  // namespace
}  // namespace ballpiston::server
