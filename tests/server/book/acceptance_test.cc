// The outcome of one Create: a new job, an earlier one, or an error.
#include "server/book/acceptance.h"

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "server/book/job_book.h"
#include "server/book/job_name.h"
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
const Principal kRoot{"root", Role::kAdmin};

v1::EnsembleSpec Question(uint64_t seed = 1) { return Equilibrium(2, 5, seed); }

// Jobs with the seeds above fail, or wait at the gate.
class AcceptanceTest : public testing::Test {
 protected:
  AcceptanceTest() { Start({}); }
  ~AcceptanceTest() override { Stop(); }

  // A new process of the server, on the same store.
  void Start(const Limits& limits) {
    Stop();
    limits_ = limits;
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

  ExperimentFactory Experiments() {
    return FakeExperimentsBySeed([this](uint64_t seed, size_t, uint64_t, std::stop_token stop) {
      if (seed == kFailingSeed) throw std::runtime_error("the ball left the cell");
      if (seed == kHeldSeed) gate_.Pass(stop);
    });
  }

  absl::StatusOr<EnsembleJob> Create(const Principal& caller,
                                     const v1::CreateEnsembleJobRequest& request) {
    return book_->Create(caller, request, CheckSpec(request.spec()));
  }

  // The id of the created or returned job.
  std::string Id(const Principal& caller, const v1::CreateEnsembleJobRequest& request) {
    const auto job = Create(caller, request);
    EXPECT_OK(job);
    return job.ok() ? *JobIdOf(job->name()) : "";
  }

  EnsembleJob::State AwaitEnd(const std::string& id) {
    AwaitThat([&] { return HasEnded(book_->Get(kRoot, id)->state()); });
    return book_->Get(kRoot, id)->state();
  }

  // Creates a job, waits for SUCCEEDED, and returns its id.
  std::string Answered(const Principal& caller, const v1::CreateEnsembleJobRequest& request) {
    const std::string id = Id(caller, request);
    EXPECT_EQ(AwaitEnd(id), EnsembleJob::SUCCEEDED);
    return id;
  }

  // Expects that the request creates a new job.
  void ExpectComputed(const Principal& caller, const v1::CreateEnsembleJobRequest& request,
                      const std::string& earlier) {
    ASSERT_OK_AND_ASSIGN(const auto job, Create(caller, request));
    EXPECT_NE(job.name(), JobName(earlier));
    EXPECT_FALSE(job.answered_from_store());
  }

  std::vector<EnsembleJob> Jobs() {
    return book_
        ->List(kRoot, {.before = std::numeric_limits<int64_t>::max(),
                       .max_jobs = 1000,
                       .max_bytes = std::numeric_limits<size_t>::max()})
        ->jobs;
  }

  std::vector<std::string> ActiveJobs() {
    std::vector<std::string> ids;
    for (const EnsembleJob& job : Jobs()) {
      if (!HasEnded(job.state())) ids.push_back(*JobIdOf(job.name()));
    }
    return ids;
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
  v1::CreateEnsembleJobRequest urgent = CreateRequest(Question());
  urgent.set_priority(100);  // is not part of the question
  for (int restarted = 0; restarted < 2; ++restarted) {
    ASSERT_OK_AND_ASSIGN(const auto again, Create(kAnn, urgent));
    EXPECT_EQ(again.name(), JobName(first));
    EXPECT_EQ(again.state(), EnsembleJob::SUCCEEDED);
    EXPECT_TRUE(again.answered_from_store());
    EXPECT_FALSE(book_->Get(kAnn, first)->answered_from_store());  // only Create says so
    Start({});
  }
  EXPECT_EQ(Jobs().size(), 1u);
}

TEST_F(AcceptanceTest, AnotherQuestionAndAFreshAnswerAreComputed) {
  const std::string first = Answered(kAnn, CreateRequest(Question()));
  ExpectComputed(kAnn, FreshRequest(Question()), first);
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
  ExpectComputed(kRoot, CreateRequest(Question()), first);
}

TEST_F(AcceptanceTest, OnlyAJobThatSucceededAnswersAgain) {
  v1::EnsembleSpec budget = Question();
  budget.mutable_target()->Clear();
  budget.mutable_target()->mutable_budget()->set_nanos(1);  // its answer depends on the machine
  ExpectComputed(kAnn, CreateRequest(budget), Answered(kAnn, CreateRequest(budget)));
  const std::string failed = Id(kAnn, CreateRequest(Question(kFailingSeed)));
  EXPECT_EQ(AwaitEnd(failed), EnsembleJob::FAILED);
  ExpectComputed(kAnn, CreateRequest(Question(kFailingSeed)), failed);
  const std::string held = Id(kAnn, CreateRequest(Question(kHeldSeed)));
  ExpectComputed(kAnn, CreateRequest(Question(kHeldSeed)), held);
  ASSERT_OK(book_->Cancel(kAnn, held, ""));
  EXPECT_EQ(AwaitEnd(held), EnsembleJob::CANCELLED);
  ExpectComputed(kAnn, CreateRequest(Question(kHeldSeed)), held);
}

TEST_F(AcceptanceTest, AnswersAreOnlyForTheirEngine) {
  for (const std::string& engine : {std::string("0.0.1"), EngineVersion()}) {
    JobRecord record;
    record.id = "of-" + std::to_string(engine == EngineVersion());
    record.principal = kAnn.name;
    record.spec = SpecBytes(Question());
    record.engine_version = engine;
    record.question = QuestionOf(Question(), engine);
    record.points = 2;
    ASSERT_OK(store_->Commit([&](Database& database) {
      InsertJob(database, record);
      EndJob(database, record.sequence, JobEnd());
    }));
  }
  EXPECT_EQ(Id(kAnn, CreateRequest(Question())), "of-1");
  ASSERT_OK(book_->Delete(kAnn, "of-1"));
  EXPECT_NE(Id(kAnn, CreateRequest(Question())), "of-0");
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
    // validate_only stores no request, so its payload does not matter. Labels are added to the job
    // that answers, so a retry may change them.
    if (field.name() == "spec" || field.name() == "request_id" || field.name() == "labels" ||
        field.name() == "validate_only") {
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
  std::set<std::string> ids;
  std::vector<std::jthread> threads;
  for (int i = 0; i < 64; ++i) {
    threads.emplace_back([&] {
      const std::string id = Id(kAnn, FreshRequest(Question(), kUuid));
      std::lock_guard lock(mutex);
      ids.insert(id);
    });
  }
  threads.clear();  // waits for them
  EXPECT_EQ(ids.size(), 1u);
  EXPECT_EQ(Jobs().size(), 1u);
}

TEST_F(AcceptanceTest, ARequestIdOfAnotherRequestIsRefused) {
  const std::string first = Id(kAnn, CreateRequest(Question(), kUuid));
  std::vector<v1::CreateEnsembleJobRequest> others(3, CreateRequest(Question(), kUuid));
  others[0].mutable_spec()->set_seed(2);
  others[1].set_fresh(true);
  others[2].set_priority(1);
  for (int restarted = 0; restarted < 2; ++restarted) {
    for (const v1::CreateEnsembleJobRequest& other : others) {
      EXPECT_THAT(Create(kAnn, other),
                  IsError(absl::StatusCode::kInvalidArgument, "REQUEST_ID_REUSED"));
    }
    EXPECT_EQ(Id(kAnn, CreateRequest(Question(), kUuid)), first);
    Start({});
  }
  EXPECT_EQ(Jobs().size(), 1u);
}

TEST_F(AcceptanceTest, EachPrincipalHasItsOwnRequestIds) {
  const std::string anns = Id(kAnn, CreateRequest(Question(), kUuid));
  const std::string bens = Id(kBen, CreateRequest(Question(2), kUuid));
  EXPECT_NE(anns, bens);
  EXPECT_EQ(Id(kBen, CreateRequest(Question(2), kUuid)), bens);
  EXPECT_THAT(book_->Get(kAnn, bens), StatusIs(absl::StatusCode::kNotFound));
}

// Otherwise the table of requests would grow each time a question is asked again.
TEST_F(AcceptanceTest, OnlyTheRequestThatMadeTheJobIsStored) {
  const std::string id = Answered(kAnn, CreateRequest(Question(), kUuid));
  for (int repeated = 0; repeated < 2; ++repeated) {
    ASSERT_OK_AND_ASSIGN(const auto again, Create(kAnn, CreateRequest(Question(), kOtherUuid)));
    EXPECT_EQ(again.name(), JobName(id));
    EXPECT_TRUE(again.answered_from_store());
  }
  const auto requests = ReadFrom(*store_, [](Database& database) {
    return database.All<std::string>("SELECT request_id FROM requests");
  });
  EXPECT_THAT(requests, ElementsAre(kUuid));
}

// ---- limits ----

// With `held` jobs of ann that wait at the gate, of one point each, the caller's request is
// refused. All limits are 3.
struct LimitRow {
  Limits limits;
  int held;
  Principal caller;
  v1::EnsembleSpec refused;
  const char* reason;
  const char* flag;
};

TEST_F(AcceptanceTest, EachLimitNamesItsReasonAndItsFlag) {
  v1::EnsembleSpec by_default = Equilibrium(5, 1);
  by_default.clear_target();
  const LimitRow rows[] = {
      {{.max_active_jobs = 3}, 3, kBen, Question(), "QUEUE_FULL", "max-active-jobs"},
      {{.max_active_jobs_per_principal = 3},
       3,
       kAnn,
       Question(),
       "TOO_MANY_JOBS",
       "max-active-jobs-per-principal"},
      {{.max_active_points = 3, .max_active_points_per_principal = 0},
       3,
       kBen,
       Question(),
       "TOO_MANY_ACTIVE_POINTS",
       "max-active-points"},
      {{.max_active_points_per_principal = 3},
       3,
       kAnn,
       Question(),
       "TOO_MANY_ACTIVE_POINTS",
       "max-active-points-per-principal"},
      {{.max_points_per_job = 3},
       0,
       kAnn,
       Equilibrium(4, 5),
       "TOO_MANY_POINTS",
       "max-points-per-job"},
      {{.max_samples_per_job = 3},
       0,
       kAnn,
       Equilibrium(2, 2),
       "TOO_MANY_SAMPLES",
       "max-samples-per-job"},
      {{.max_samples_per_job = 3}, 0, kAnn, by_default, "TOO_MANY_SAMPLES", "max-samples-per-job"}};
  for (const LimitRow& row : rows) {
    SCOPED_TRACE(row.flag);
    const std::string id = "123e4567-e89b-12d3-a456-42661417400" + std::to_string(&row - rows);
    Start(row.limits);
    std::string held;
    for (int i = 0; i < row.held; ++i) held = Id(kAnn, FreshRequest(Equilibrium(1, 5, kHeldSeed)));
    for (int repeated = 0; repeated < 2; ++repeated) {  // a refused job does not count
      const auto refused = Create(row.caller, CreateRequest(row.refused, id));
      EXPECT_THAT(refused, IsError(absl::StatusCode::kResourceExhausted, row.reason));
      EXPECT_THAT(std::string(refused.status().message()), HasSubstr(std::string("--") + row.flag));
      const ErrorDetails details = DetailsOf(refused.status());
      EXPECT_EQ(details.domain, "ballpiston");
      EXPECT_EQ(details.metadata.at("flag"), row.flag);
      EXPECT_EQ(details.metadata.at("limit"), "3");
    }
    if (held.empty()) continue;
    ASSERT_OK(book_->Cancel(kAnn, held, ""));
    AwaitEnd(held);
    // No job was created with the id.
    EXPECT_OK(Create(row.caller, FreshRequest(Equilibrium(1, 5), id)));
    for (const std::string& job : ActiveJobs())
      book_->Cancel(kRoot, job, "").status().IgnoreError();
    AwaitThat([this] { return ActiveJobs().empty(); });
  }
}

TEST_F(AcceptanceTest, RetriesAndStoredAnswersIgnoreALowerLimit) {
  const std::string answered = Answered(kAnn, CreateRequest(Question(), kUuid));
  Start({.max_active_jobs = 1, .max_points_per_job = 1});
  Id(kAnn, FreshRequest(Equilibrium(1, 5, kHeldSeed)));
  EXPECT_EQ(Id(kAnn, CreateRequest(Question(), kUuid)), answered);
  EXPECT_EQ(Id(kAnn, CreateRequest(Question())), answered);
  // Another request with the same id is rejected because of the id.
  EXPECT_EQ(ReasonOf(Create(kAnn, CreateRequest(Question(3), kUuid))), "REQUEST_ID_REUSED");
  EXPECT_EQ(ReasonOf(Create(kAnn, FreshRequest(Question()))), "TOO_MANY_POINTS");
}

TEST_F(AcceptanceTest, ZeroMeansUnlimited) {
  Start({.max_active_jobs = 0,
         .max_active_jobs_per_principal = 0,
         .max_active_points = 0,
         .max_active_points_per_principal = 0,
         .max_points_per_job = 0,
         .max_samples_per_job = 0});
  for (int i = 0; i < 5; ++i) EXPECT_OK(Create(kAnn, FreshRequest(Equilibrium(50, 1000))));
}

// ---- validate_only ----

TEST(AcceptanceRpc, ValidateOnlyChecksLimitsReturnsStoredAnswersAndCreatesNoJob) {
  RunningServer server({.limits = {.max_points_per_job = 3, .max_samples_per_job = 100}});
  const std::string answered = server.Succeeded(Question());
  const struct {
    v1::EnsembleSpec spec;
    const char* reason;
    std::string name;
  } rows[] = {{Equilibrium(4, 1), "TOO_MANY_POINTS", ""},
              {Equilibrium(3, 40), "TOO_MANY_SAMPLES", ""},
              {Equilibrium(3, 30), "", ""},
              {Question(), "", answered}};
  for (const auto& [spec, reason, name] : rows) {
    v1::CreateEnsembleJobRequest request = CreateRequest(spec, kUuid);
    request.set_validate_only(true);
    EnsembleJob job;
    EXPECT_EQ(ReasonOf(server.Create(request, &job)), reason);
    EXPECT_EQ(job.name(), name);
    EXPECT_EQ(job.answered_from_store(), !name.empty());
  }
  EXPECT_EQ(server.List().jobs_size(), 1);
  // The id was not stored, so another question can use it.
  EXPECT_NE(server.Created(CreateRequest(Question(2), kUuid)).name(), answered);
}

}  // namespace
}  // namespace ballpiston::server
