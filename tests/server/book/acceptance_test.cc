// The outcome of one Create: a new job, an earlier one, or an error. Most tests use the book of
// jobs, which has the principals; the last ones use the API.
#include "server/book/acceptance.h"

#include <condition_variable>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/book/job_book.h"
#include "server/store/job_table.h"
#include "tests/server/error_details.h"
#include "tests/server/factory_opener.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"
#include "tests/server/running_server.h"
#include "tests/server/store_access.h"
#include "tests/server/thread_pool.h"
#include "tests/support/await.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using v1::EnsembleJob;

constexpr uint64_t kFailingSeed = 13;
constexpr uint64_t kHeldSeed = 14;

const Principal kAnn{"ann", Role::kSubmit};
const Principal kBen{"ben", Role::kSubmit};

v1::EnsembleSpec Question(uint64_t seed = 1) { return Equilibrium(2, 5, seed); }

// Jobs with the seeds above fail, or wait at the gate.
class AcceptanceTest : public testing::Test {
 protected:
  AcceptanceTest() { Start(); }
  ~AcceptanceTest() override { Stop(); }

  void Start() {
    ASSERT_OK_AND_ASSIGN(store_,
                         Store::Open(folder_.File("store"),
                                     {.delay = std::chrono::milliseconds(1), .stall = kNever}));
    pool_ = std::make_unique<ThreadPool>(2, Experiments());
    book_ = std::make_unique<JobBook>(*store_, limits_, pool_->scheduler());
    ASSERT_OK(book_->Resume());
  }

  void Stop() {
    book_.reset();
    pool_.reset();
    store_.reset();
  }

  void StartAgain() {
    Stop();
    Start();
  }

  ExperimentFactory Experiments() {
    return FakeExperimentsBySeed([this](uint64_t seed, size_t, uint64_t, std::stop_token stop) {
      if (seed == kFailingSeed) throw std::runtime_error("the ball left the cell");
      if (seed == kHeldSeed) gate_.Pass(stop);
    });
  }

  absl::StatusOr<EnsembleJob> Create(const Principal& caller,
                                     const v1::CreateEnsembleJobRequest& request) {
    const CheckedSpec checked = CheckSpec(request.spec());
    EXPECT_TRUE(checked.violations.empty()) << checked.violations[0].description;
    return book_->Create(caller, request, checked);
  }

  // The name of the created or returned job.
  std::string Name(const Principal& caller, const v1::CreateEnsembleJobRequest& request) {
    const auto job = Create(caller, request);
    EXPECT_OK(job);
    return job.ok() ? job->name() : "";
  }

  static std::string IdOf(const std::string& name) { return name.substr(name.find('/') + 1); }

  EnsembleJob AwaitEnd(const std::string& name) {
    absl::StatusOr<EnsembleJob> job;
    AwaitThat([&] {
      job = book_->Get({"", Role::kAdmin}, IdOf(name));
      return !job.ok() || HasEnded(job->state());
    });
    EXPECT_OK(job);
    return job.ok() ? *std::move(job) : EnsembleJob();
  }

  // Creates a job, waits for SUCCEEDED, and returns its name.
  std::string Answered(const Principal& caller, const v1::CreateEnsembleJobRequest& request) {
    const std::string name = Name(caller, request);
    EXPECT_EQ(AwaitEnd(name).state(), EnsembleJob::SUCCEEDED);
    return name;
  }

  // Expects that the request creates a new job.
  void ExpectComputed(const Principal& caller, const v1::CreateEnsembleJobRequest& request,
                      const std::string& earlier) {
    ASSERT_OK_AND_ASSIGN(const auto job, Create(caller, request));
    EXPECT_NE(job.name(), earlier);
    EXPECT_FALSE(job.answered_from_store());
  }

  size_t Jobs() {
    const auto page =
        book_->List({"", Role::kAdmin}, {.before = std::numeric_limits<int64_t>::max(),
                                         .max_jobs = 1000,
                                         .max_bytes = std::numeric_limits<size_t>::max()});
    EXPECT_OK(page);
    return page.ok() ? page->jobs.size() : 0;
  }

  Limits limits_;
  Gate gate_;
  TemporaryFolder folder_;
  std::unique_ptr<Store> store_;
  std::unique_ptr<ThreadPool> pool_;
  std::unique_ptr<JobBook> book_;
};

// ---- the same question ----

TEST_F(AcceptanceTest, TheSameQuestionIsAnsweredByTheJobThatSucceeded) {
  const std::string first = Answered(kAnn, CreateRequest(Question()));
  ASSERT_OK_AND_ASSIGN(const auto again, Create(kAnn, CreateRequest(Question())));
  EXPECT_EQ(again.name(), first);
  EXPECT_EQ(again.state(), EnsembleJob::SUCCEEDED);
  EXPECT_TRUE(again.answered_from_store());
  EXPECT_EQ(Jobs(), 1u);
  // Only the answer to Create says so.
  EXPECT_FALSE(book_->Get(kAnn, IdOf(first))->answered_from_store());
  StartAgain();
  EXPECT_TRUE(Create(kAnn, CreateRequest(Question()))->answered_from_store());
}

TEST_F(AcceptanceTest, ThePriorityIsNotPartOfTheQuestion) {
  const std::string first = Answered(kAnn, CreateRequest(Question()));
  v1::CreateEnsembleJobRequest urgent = CreateRequest(Question());
  urgent.set_priority(100);
  EXPECT_EQ(Name(kAnn, urgent), first);
}

TEST_F(AcceptanceTest, AFreshAnswerIsComputed) {
  const std::string first = Answered(kAnn, CreateRequest(Question()));
  ExpectComputed(kAnn, FreshRequest(Question()), first);
}

TEST_F(AcceptanceTest, ABudgetsAnswerIsComputed) {
  v1::EnsembleSpec spec = Question();
  spec.mutable_target()->Clear();
  spec.mutable_target()->mutable_budget()->set_nanos(1);
  const std::string first = Answered(kAnn, CreateRequest(spec));
  ExpectComputed(kAnn, CreateRequest(spec), first);
}

TEST_F(AcceptanceTest, AnotherQuestionIsComputed) {
  const std::string first = Answered(kAnn, CreateRequest(Question()));
  std::vector<v1::EnsembleSpec> others(5, Question());
  others[0].set_seed(2);
  others[1].set_model(v1::EnsembleSpec::BILLIARD);
  others[2].set_precision(v1::EnsembleSpec::SINGLE);
  others[3].set_verify(true);
  others[4].mutable_target()->set_collisions(6);
  for (const v1::EnsembleSpec& other : others) ExpectComputed(kAnn, CreateRequest(other), first);
}

TEST_F(AcceptanceTest, AnswersAreOnlyForTheirPrincipal) {
  const std::string first = Answered(kAnn, CreateRequest(Question()));
  ExpectComputed(kBen, CreateRequest(Question()), first);
  // An administrator can see the job, but it is the answer to another principal.
  ExpectComputed({"root", Role::kAdmin}, CreateRequest(Question()), first);
}

TEST_F(AcceptanceTest, AFailedQuestionIsComputedAgain) {
  const std::string failed = Name(kAnn, CreateRequest(Question(kFailingSeed)));
  EXPECT_EQ(AwaitEnd(failed).state(), EnsembleJob::FAILED);
  ExpectComputed(kAnn, CreateRequest(Question(kFailingSeed)), failed);
}

TEST_F(AcceptanceTest, QuestionsOfActiveAndCancelledJobsAreComputedAgain) {
  const std::string held = Name(kAnn, CreateRequest(Question(kHeldSeed)));
  gate_.AwaitWaiting(1);
  ASSERT_OK_AND_ASSIGN(const auto second, Create(kAnn, CreateRequest(Question(kHeldSeed))));
  EXPECT_NE(second.name(), held);
  for (const std::string& name : {held, second.name()}) {
    ASSERT_OK(book_->Cancel(kAnn, IdOf(name), ""));
  }
  EXPECT_EQ(AwaitEnd(held).state(), EnsembleJob::CANCELLED);
  ExpectComputed(kAnn, CreateRequest(Question(kHeldSeed)), held);
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

TEST_F(AcceptanceTest, AnswersAreOnlyForTheirEngine) {
  const auto insert_succeeded = [&](JobRecord record) {
    const auto insert = [&](Database& database) {
      InsertJob(database, record);
      JobEnd end;
      end.time = absl::Now();
      EndJob(database, record.sequence, end);
    };
    ASSERT_OK(store_->Commit(insert));
  };
  insert_succeeded(AnnsJob("of-another-engine", "0.0.1"));
  const std::string computed = Answered(kAnn, CreateRequest(Question()));
  EXPECT_NE(computed, "ensembleJobs/of-another-engine");
  ASSERT_OK(book_->Delete(kAnn, IdOf(computed)));
  insert_succeeded(AnnsJob("of-this-engine", EngineVersion()));
  EXPECT_EQ(Name(kAnn, CreateRequest(Question())), "ensembleJobs/of-this-engine");
}

TEST_F(AcceptanceTest, AJobThatThisEngineComputedAgainIsReturned) {
  JobRecord record = AnnsJob("unfinished", "0.0.1");
  ASSERT_OK(store_->Commit([&](Database& database) { InsertJob(database, record); }));
  StartAgain();
  EXPECT_EQ(AwaitEnd("ensembleJobs/unfinished").state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(Name(kAnn, CreateRequest(Question())), "ensembleJobs/unfinished");
}

// ---- which questions are the same ----

using google::protobuf::FieldDescriptor;

void SetOther(google::protobuf::Message& message, const FieldDescriptor& field) {
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
    case FieldDescriptor::CPPTYPE_STRING:
      return field.is_repeated() ? reflect.AddString(&message, &field, "77")
                                 : reflect.SetString(&message, &field, "77");
    case FieldDescriptor::CPPTYPE_ENUM:
      return reflect.SetEnumValue(&message, &field, field.enum_type()->value_count() - 1);
    default:
      ADD_FAILURE() << field.full_name() << " is of a kind that this test does not know";
  }
}

// Calls `visit` for each field of `whole` and of its messages, with a copy in which only this field
// differs.
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
    google::protobuf::Message* holder = &changed;
    for (const int number : path) {
      holder = holder->GetReflection()->MutableMessage(
          holder, holder->GetDescriptor()->FindFieldByNumber(number));
    }
    SetOther(*holder, field);
    visit(field, changed);
  }
}

TEST(Question, EveryFieldOfTheSpecificationIsPartOfIt) {
  std::map<std::string, std::string> fields = {{QuestionOf(Question(), "1"), "none"}};
  int changes = 0;
  WithEachFieldChanged(Question(), {}, *v1::EnsembleSpec::descriptor(),
                       [&](const FieldDescriptor& field, const v1::EnsembleSpec& changed) {
                         ++changes;
                         const std::string question = QuestionOf(changed, "1");
                         if (changed.target().has_budget()) {
                           EXPECT_EQ(question, "") << field.full_name();  // it has no answer
                           return;
                         }
                         EXPECT_NE(question, "");
                         const auto [same, is_new] = fields.emplace(question, field.full_name());
                         EXPECT_TRUE(is_new)
                             << field.full_name() << " makes the same question as " << same->second;
                       });
  EXPECT_GE(changes, 15);
}

TEST(Question, TheDefaultEstimateMayBeNamedOrLeftOut) {
  v1::EnsembleSpec gas = Question();
  gas.set_experiment(v1::EnsembleSpec::GAS_EQUILIBRIUM);
  const auto question_of = [&gas](const std::string& estimate) {
    gas.mutable_target()->set_estimate(estimate);
    return QuestionOf(gas, "1") + " " + PayloadOf(CreateRequest(gas, kUuid));
  };
  EXPECT_EQ(question_of("exchange_rate"), question_of(""));
  EXPECT_NE(question_of("conductivity"), question_of(""));
  EXPECT_NE(question_of("unknown"), question_of(""));
  gas.set_experiment(v1::EnsembleSpec::GAS_CONDUCTION);
  EXPECT_EQ(question_of("heat_current"), question_of(""));
  EXPECT_NE(question_of("exchange_rate"), question_of(""));
  // A newer client can name an experiment that this server does not know.
  gas.set_experiment(static_cast<v1::EnsembleSpec::Experiment>(999));
  EXPECT_NE(question_of("exchange_rate"), question_of(""));
}

TEST(Question, TheEngineIsPartOfIt) {
  EXPECT_NE(QuestionOf(Question(), "1"), QuestionOf(Question(), "2"));
  EXPECT_EQ(QuestionOf(Question(), "1"), QuestionOf(Question(), "1"));
}

TEST(Payload, EveryFieldExceptTheIdAndTheLabelsIsPartOfTheHash) {
  const v1::CreateEnsembleJobRequest request = CreateRequest(Question(), kUuid);
  std::map<std::string, std::string> fields = {{PayloadOf(request), "none"}};
  const auto expect_new = [&](const FieldDescriptor& field,
                              const v1::CreateEnsembleJobRequest& changed) {
    const auto [same, is_new] = fields.emplace(PayloadOf(changed), field.full_name());
    EXPECT_TRUE(is_new) << field.full_name() << " makes the same payload as " << same->second;
  };
  const google::protobuf::Descriptor& type = *v1::CreateEnsembleJobRequest::descriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    // validate_only stores no request, so its payload does not matter.
    // Labels are added to the job that answers, so a retry may change them.
    if (field.name() == "spec" || field.name() == "request_id" || field.name() == "validate_only" ||
        field.name() == "labels") {
      continue;
    }
    v1::CreateEnsembleJobRequest changed = request;
    SetOther(changed, field);
    expect_new(field, changed);
  }
  WithEachFieldChanged(Question(), {}, *v1::EnsembleSpec::descriptor(),
                       [&](const FieldDescriptor& field, const v1::EnsembleSpec& spec) {
                         expect_new(field, CreateRequest(spec, kUuid));
                       });
  EXPECT_EQ(PayloadOf(CreateRequest(Question(), "another")), PayloadOf(request));
}

// ---- the same request ----

TEST_F(AcceptanceTest, ConcurrentRequestsWithOneIdMakeOneJob) {
  std::mutex mutex;
  std::set<std::string> names;
  std::vector<std::thread> threads;
  for (int i = 0; i < 64; ++i) {
    threads.emplace_back([&] {
      const std::string name = Name(kAnn, FreshRequest(Question(), kUuid));
      std::lock_guard lock(mutex);
      names.insert(name);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(names.size(), 1u);
  EXPECT_EQ(Jobs(), 1u);
}

TEST_F(AcceptanceTest, ARetryReturnsTheSameJobAfterARestart) {
  const std::string held = Name(kAnn, FreshRequest(Question(kHeldSeed), kUuid));
  StartAgain();
  ASSERT_OK_AND_ASSIGN(const auto active, Create(kAnn, FreshRequest(Question(kHeldSeed), kUuid)));
  EXPECT_EQ(active.name(), held);
  EXPECT_FALSE(active.answered_from_store());
  gate_.Open();
  EXPECT_EQ(AwaitEnd(held).state(), EnsembleJob::SUCCEEDED);
  StartAgain();
  const auto ended = Create(kAnn, FreshRequest(Question(kHeldSeed), kUuid));
  EXPECT_EQ(ended->name(), held);
  EXPECT_FALSE(ended->answered_from_store());
  EXPECT_EQ(Jobs(), 1u);
}

// A retry returns the same answer as the first request.
TEST_F(AcceptanceTest, ARetryOfAStoredAnswerReturnsTheSameJob) {
  const std::string first = Answered(kAnn, CreateRequest(Question()));
  for (int i = 0; i < 2; ++i) {
    const auto answer = Create(kAnn, CreateRequest(Question(), kUuid));
    EXPECT_EQ(answer->name(), first);
    EXPECT_TRUE(answer->answered_from_store());
    StartAgain();
  }
}

TEST_F(AcceptanceTest, ARequestIdOfAnotherRequestIsRefused) {
  const std::string first = Name(kAnn, CreateRequest(Question(), kUuid));
  std::vector<v1::CreateEnsembleJobRequest> others(3, CreateRequest(Question(), kUuid));
  others[0].mutable_spec()->set_seed(2);
  others[1].set_fresh(true);
  others[2].set_priority(1);
  for (int restarted = 0; restarted < 2; ++restarted) {
    for (const v1::CreateEnsembleJobRequest& other : others) {
      const absl::Status refused = Create(kAnn, other).status();
      EXPECT_THAT(refused, IsError(absl::StatusCode::kInvalidArgument, "REQUEST_ID_REUSED"));
    }
    EXPECT_EQ(Name(kAnn, CreateRequest(Question(), kUuid)), first);
    StartAgain();
  }
  EXPECT_EQ(Jobs(), 1u);
}

TEST_F(AcceptanceTest, EachPrincipalHasItsOwnRequestIds) {
  const std::string anns = Name(kAnn, CreateRequest(Question(), kUuid));
  const std::string bens = Name(kBen, CreateRequest(Question(2), kUuid));
  EXPECT_NE(anns, bens);
  EXPECT_EQ(Name(kAnn, CreateRequest(Question(), kUuid)), anns);
  EXPECT_EQ(Name(kBen, CreateRequest(Question(2), kUuid)), bens);
  EXPECT_THAT(book_->Get(kAnn, IdOf(bens)), StatusIs(absl::StatusCode::kNotFound));
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
    return Name(caller, FreshRequest(Question(kHeldSeed), request_id));
  }

  void ExpectRefused(const absl::StatusOr<EnsembleJob>& refused, const std::string& reason,
                     const std::string& flag, const std::string& limit) {
    EXPECT_THAT(refused, IsError(absl::StatusCode::kResourceExhausted, reason));
    const ErrorDetails details = DetailsOf(refused.status());
    EXPECT_EQ(details.domain, "ballpiston");
    EXPECT_EQ(details.metadata.at("flag"), flag);
    EXPECT_EQ(details.metadata.at("limit"), limit);
    EXPECT_THAT(std::string(refused.status().message()), HasSubstr("--" + flag));
  }
};

TEST_F(LimitTest, AFullQueueRefusesOnlyNewJobs) {
  const std::string answered = Answered(kAnn, CreateRequest(Question()));
  Limit({.max_active_jobs = 2});
  const std::string first = Hold(kAnn, kUuid);
  Hold(kBen);
  for (const Principal& caller : {kAnn, kBen}) {
    ExpectRefused(Create(caller, CreateRequest(Question(2))), "QUEUE_FULL", "max-active-jobs", "2");
  }
  // A retry, and a question that the store can answer.
  EXPECT_EQ(Name(kAnn, FreshRequest(Question(kHeldSeed), kUuid)), first);
  EXPECT_EQ(Name(kAnn, CreateRequest(Question())), answered);
  // Another request with the same id is rejected because of the id.
  EXPECT_EQ(ReasonOf(Create(kAnn, CreateRequest(Question(3), kUuid))), "REQUEST_ID_REUSED");
  EXPECT_EQ(Jobs(), 3u);
  ASSERT_OK(book_->Cancel(kAnn, IdOf(first), ""));
  AwaitEnd(first);
  EXPECT_OK(Create(kAnn, CreateRequest(Question(2))));
}

TEST_F(LimitTest, JobsAreCountedByPrincipal) {
  Limit({.max_active_jobs_per_principal = 1});
  Hold(kAnn);
  ExpectRefused(Create(kAnn, CreateRequest(Question())), "TOO_MANY_JOBS",
                "max-active-jobs-per-principal", "1");
  EXPECT_OK(Create(kBen, CreateRequest(Question())));
}

// The id can be used again, because no job was created with it.
TEST_F(LimitTest, ARefusedRequestCanBeRetried) {
  Limit({.max_active_jobs = 1});
  const std::string first = Hold(kAnn);
  EXPECT_EQ(ReasonOf(Create(kAnn, CreateRequest(Question(), kUuid))), "QUEUE_FULL");
  ASSERT_OK(book_->Cancel(kAnn, IdOf(first), ""));
  AwaitEnd(first);
  EXPECT_OK(Create(kAnn, CreateRequest(Question(), kUuid)));
}

TEST_F(LimitTest, AJobMayNotHaveTooManyPoints) {
  Limit({.max_points_per_job = 3});
  EXPECT_OK(Create(kAnn, CreateRequest(Equilibrium(3, 5))));
  ExpectRefused(Create(kAnn, CreateRequest(Equilibrium(4, 5))), "TOO_MANY_POINTS",
                "max-points-per-job", "3");
}

TEST_F(LimitTest, AJobMayNotTakeTooManySamples) {
  Limit({.max_samples_per_job = 40'000});
  EXPECT_OK(Create(kAnn, CreateRequest(Equilibrium(4, 10'000))));
  ExpectRefused(Create(kAnn, CreateRequest(Equilibrium(4, 10'001))).status(), "TOO_MANY_SAMPLES",
                "max-samples-per-job", "40000");
  v1::EnsembleSpec by_default = Equilibrium(5, 1);
  by_default.clear_target();
  EXPECT_EQ(ReasonOf(Create(kAnn, CreateRequest(by_default))), "TOO_MANY_SAMPLES");
  // The number of samples is not known in advance.
  v1::EnsembleSpec tolerance = Equilibrium(5, 1);
  tolerance.mutable_target()->set_tolerance(0.1);
  EXPECT_OK(Create(kAnn, CreateRequest(tolerance)));
}

TEST_F(LimitTest, ThePointsOfActiveJobsAreLimited) {
  Limit({.max_active_points = 20, .max_active_points_per_principal = 6});
  const auto held = [](int points, const char* request_id = "") {
    return FreshRequest(Equilibrium(points, 5, kHeldSeed), request_id);
  };
  const std::string first = Name(kAnn, held(4, kUuid));
  const auto expect_full = [&] {
    ExpectRefused(Create(kAnn, held(3)), "TOO_MANY_ACTIVE_POINTS",
                  "max-active-points-per-principal", "6");
  };
  expect_full();
  Name(kBen, held(6));
  Name({"eve", Role::kSubmit}, held(6));
  ExpectRefused(Create({"zoe", Role::kSubmit}, held(5)), "TOO_MANY_ACTIVE_POINTS",
                "max-active-points", "20");
  EXPECT_EQ(Name(kAnn, held(4, kUuid)), first);  // a replay
  StartAgain();
  expect_full();
  ASSERT_OK(book_->Cancel(kAnn, IdOf(first), ""));
  AwaitEnd(first);
  EXPECT_OK(Create(kAnn, held(3)));
}

// A job that is not created does not count.
TEST_F(LimitTest, PointsOfJobsThatAreNotCreatedDoNotCount) {
  Limit({.max_active_points = 4, .max_active_points_per_principal = 0});
  const std::string answered = Answered(kAnn, CreateRequest(Equilibrium(3, 5)));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(Name(kAnn, CreateRequest(Equilibrium(3, 5))), answered);
    EXPECT_EQ(ReasonOf(Create(kAnn, CreateRequest(Equilibrium(5, 5)))), "TOO_MANY_ACTIVE_POINTS");
  }
  AwaitEnd(Name(kAnn, FreshRequest(Equilibrium(4, 5))));
}

// Otherwise the table of requests would grow each time a question is asked again.
TEST_F(AcceptanceTest, OnlyTheRequestThatMadeTheJobIsStored) {
  const std::string name = Answered(kAnn, CreateRequest(Question(), kUuid));
  for (int i = 1; i <= 3; ++i) {
    const std::string id = "123e4567-e89b-12d3-a456-42661417400" + std::to_string(i);
    for (int repeated = 0; repeated < 2; ++repeated) {
      ASSERT_OK_AND_ASSIGN(const auto again, Create(kAnn, CreateRequest(Question(), id)));
      EXPECT_EQ(again.name(), name);
      EXPECT_TRUE(again.answered_from_store());
    }
  }
  const auto requests = ReadFrom(*store_, [](Database& database) {
    return database.All<std::string>("SELECT request_id FROM requests");
  });
  EXPECT_THAT(requests, ElementsAre(kUuid));
}

TEST_F(LimitTest, RetriesAndStoredAnswersIgnoreALowerLimit) {
  const std::string name = Answered(kAnn, CreateRequest(Equilibrium(4, 5), kUuid));
  Limit({.max_points_per_job = 3});
  EXPECT_EQ(Name(kAnn, CreateRequest(Equilibrium(4, 5), kUuid)), name);
  EXPECT_EQ(Name(kAnn, CreateRequest(Equilibrium(4, 5))), name);
  EXPECT_EQ(ReasonOf(Create(kAnn, FreshRequest(Equilibrium(4, 5)))), "TOO_MANY_POINTS");
}

TEST_F(LimitTest, ZeroMeansUnlimited) {
  Limit({.max_active_jobs = 0,
         .max_active_jobs_per_principal = 0,
         .max_active_points = 0,
         .max_active_points_per_principal = 0,
         .max_points_per_job = 0,
         .max_samples_per_job = 0});
  for (int i = 0; i < 5; ++i) EXPECT_OK(Create(kAnn, FreshRequest(Equilibrium(50, 1000))));
}

// ---- through the API ----

TEST(AcceptanceRpc, APriorityOutOfRangeIsAViolation) {
  RunningServer server;
  for (const int priority : {-101, 101, std::numeric_limits<int32_t>::min()}) {
    v1::CreateEnsembleJobRequest request = CreateRequest(Question());
    request.set_priority(priority);
    const grpc::Status status = server.Create(request);
    EXPECT_THAT(status, StatusIs(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("-100 to 100")));
    EXPECT_THAT(DetailsOf(status).fields, ElementsAre("priority"));
  }
  for (const int priority : {-100, 100}) {
    v1::CreateEnsembleJobRequest request = FreshRequest(Question());
    request.set_priority(priority);
    const EnsembleJob job = server.Created(request);
    EXPECT_EQ(job.priority(), priority);
    EXPECT_EQ(job.principal(), "local");
  }
  EXPECT_EQ(server.List().jobs_size(), 2);
}

TEST(AcceptanceRpc, ValidateOnlyChecksLimitsAndCreatesNoJob) {
  RunningServer server({.limits = {.max_points_per_job = 3, .max_samples_per_job = 100}});
  const std::pair<v1::EnsembleSpec, const char*> questions[] = {
      {Equilibrium(4, 1), "TOO_MANY_POINTS"},
      {Equilibrium(3, 40), "TOO_MANY_SAMPLES"},
      {Equilibrium(3, 30), ""}};
  for (const auto& [spec, reason] : questions) {
    v1::CreateEnsembleJobRequest request = CreateRequest(spec, kUuid);
    request.set_validate_only(true);
    EnsembleJob job;
    EXPECT_THAT(
        server.Create(request, &job),
        IsError(*reason == '\0' ? grpc::StatusCode::OK : grpc::StatusCode::RESOURCE_EXHAUSTED,
                reason));
    EXPECT_EQ(job.name(), "");
    EXPECT_FALSE(job.answered_from_store());
  }
  EXPECT_EQ(server.List().jobs_size(), 0);
}

TEST(AcceptanceRpc, ValidateOnlyReturnsAStoredAnswer) {
  RunningServer server({.limits = {.max_active_jobs = 1}});
  const std::string answered = server.Succeeded(Question());
  v1::CreateEnsembleJobRequest request = CreateRequest(Question(), kUuid);
  request.set_validate_only(true);
  const EnsembleJob job = server.Created(request);
  EXPECT_EQ(job.name(), answered);
  EXPECT_TRUE(job.answered_from_store());
  EXPECT_EQ(server.List().jobs_size(), 1);
  // The id was not stored, so another question can use it.
  const EnsembleJob another = server.Created(CreateRequest(Question(2), kUuid));
  EXPECT_NE(another.name(), answered);
  server.AwaitEnd(another.name());
}

}  // namespace
}  // namespace ballpiston::server
