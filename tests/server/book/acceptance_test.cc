// The outcome of one Create: a new job, an earlier one, or an error.
#include "server/book/acceptance.h"

#include "tests/server/book/book_test.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

v1::EnsembleSpec Question(uint64_t seed = 1) { return Equilibrium(2, 5, seed); }

v1::CreateEnsembleJobRequest Labelled(v1::CreateEnsembleJobRequest request, const std::string& key,
                                      const std::string& value) {
  (*request.mutable_labels())[key] = value;
  return request;
}

class AcceptanceTest : public BookTest {
 protected:
  // Expects that the request creates a new job.
  void ExpectComputed(const Principal& caller, const v1::CreateEnsembleJobRequest& request,
                      const std::string& earlier) {
    ASSERT_OK_AND_ASSIGN(const auto job, Create(caller, request));
    EXPECT_NE(job.name(), JobName(earlier));
    EXPECT_FALSE(job.answered_from_store());
  }
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
    EXPECT_FALSE(Get(first).answered_from_store());  // only Create says so
    Start();
  }
  EXPECT_EQ(List(Query(), kRoot).jobs.size(), 1u);
}

// An administrator can see the job, but it is the answer to another principal.
TEST_F(AcceptanceTest, OtherQuestionsPrincipalsAndFreshAnswersAreComputed) {
  const std::string first = Answered(kAnn, CreateRequest(Question()));
  ExpectComputed(kAnn, FreshRequest(Question()), first);
  ExpectComputed(kAnn, CreateRequest(Question(2)), first);
  ExpectComputed(kBen, CreateRequest(Question()), first);
  ExpectComputed(kRoot, CreateRequest(Question()), first);
}

TEST_F(AcceptanceTest, OnlyAJobThatSucceededAnswersAgain) {
  v1::EnsembleSpec budget = Question();
  budget.mutable_target()->Clear();
  budget.mutable_target()->mutable_budget()->set_nanos(1);  // its answer depends on the machine
  ExpectComputed(kAnn, CreateRequest(budget), Answered(kAnn, CreateRequest(budget)));
  const auto failing = CreateRequest(Question(kFailingSeed));
  const std::string failed = Id(kAnn, failing);
  EXPECT_EQ(AwaitEnd(failed), EnsembleJob::FAILED);
  ExpectComputed(kAnn, failing, failed);
  const auto waiting = CreateRequest(Question(kHeldSeed));
  const std::string held = Id(kAnn, waiting);
  ExpectComputed(kAnn, waiting, held);
  ASSERT_OK(book_->Cancel(kAnn, held, ""));
  EXPECT_EQ(AwaitEnd(held), EnsembleJob::CANCELLED);
  ExpectComputed(kAnn, waiting, held);
}

// ---- which questions are the same ----

using google::protobuf::FieldDescriptor;

// Gives the field another value, or adds one to a repeated field.
void SetOther(google::protobuf::Message& message, const FieldDescriptor& field) {
  std::string value = "77";
  if (field.cpp_type() == FieldDescriptor::CPPTYPE_STRING) value = "'77'";
  if (field.cpp_type() == FieldDescriptor::CPPTYPE_BOOL) {
    value = message.GetReflection()->GetBool(message, &field) ? "false" : "true";
  }
  if (const auto* values = field.enum_type())
    value = values->value(values->value_count() - 1)->name();
  EXPECT_TRUE(google::protobuf::TextFormat::MergeFromString(field.name() + ": " + value, &message))
      << field.full_name();
}

// Calls `visit` with one field of the message changed, for each field of it and of its messages.
// Then changes the field back.
void ChangeEachField(google::protobuf::Message& message,
                     const std::function<void(const FieldDescriptor&)>& visit) {
  const std::unique_ptr<google::protobuf::Message> before(message.New());
  before->CopyFrom(message);
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor& field = *message.GetDescriptor()->field(i);
    if (field.is_map()) continue;
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      ChangeEachField(*message.GetReflection()->MutableMessage(&message, &field), visit);
    } else {
      SetOther(message, field);
      visit(field);
    }
    message.CopyFrom(*before);
  }
}

// A retry may have other labels. A question has a whole specification, a family has one without the
// number that its target asks for; a job with a budget has neither.
TEST(Acceptance, PayloadQuestionAndFamilyDependOnTheirFieldsOnly) {
  v1::CreateEnsembleJobRequest request = CreateRequest(Question(), kUuid);
  const auto question_of = [&](const char* engine) { return QuestionOf(request.spec(), engine); };
  const auto family_of = [&](const char* engine) { return FamilyOf(request.spec(), engine); };
  const std::string payload = PayloadOf(request);
  const std::string family = family_of("1");
  std::set<std::string> payloads = {payload};
  std::set<std::string> questions = {question_of("1"), family};
  std::set<std::string> families = {family};
  EXPECT_EQ(PayloadOf(Labelled(request, "figure", "3")), payload);
  for (const std::string& other : {question_of("2"), family_of("2")}) {
    EXPECT_TRUE(questions.insert(other).second);
  }
  ChangeEachField(request, [&](const FieldDescriptor& field) {
    SCOPED_TRACE(field.full_name());
    EXPECT_EQ(payloads.insert(PayloadOf(request)).second, field.name() != "request_id");
    if (request.spec().target().has_budget()) {
      EXPECT_EQ(question_of("1") + family_of("1"), "");
      return;
    }
    const bool is_in_spec = field.containing_type() != request.GetDescriptor();
    EXPECT_EQ(questions.insert(question_of("1")).second, is_in_spec);
    EXPECT_EQ(families.insert(family_of("1")).second,
              is_in_spec && field.real_containing_oneof() == nullptr);
  });
  EXPECT_GE(payloads.size(), 18u);
}

// The default estimate and default values may be named or left out, and columns have no order.
TEST(Question, TextsWithTheSameMeaningGiveTheSameQuestion) {
  const auto all_of = [](const std::string& text) {
    const auto spec = FromText<v1::EnsembleSpec>("grid { rho: 0.53 delta: 0.1 } " + text);
    return std::tuple(QuestionOf(spec, "1"), FamilyOf(spec, "1"), PayloadOf(CreateRequest(spec)));
  };
  const std::string gas = "experiment: GAS_EQUILIBRIUM ", steady = "experiment: GAS_CONDUCTION ";
  const std::string unknown = "experiment: 999 ";  // of a newer client
  const std::string rate = "target { estimate: 'exchange_rate' }";
  const std::string defaults =
      "model: AUTO precision: DOUBLE target { samples: " + std::to_string(kDefaultSamples) + " } ";
  EXPECT_EQ(all_of(gas + rate), all_of(gas));
  EXPECT_EQ(all_of(steady + "target { estimate: 'heat_current' }"), all_of(steady));
  EXPECT_EQ(all_of(gas + defaults + "grid { table: ['rho', 'delta'] }"),
            all_of(gas + "grid { table: ['delta', 'rho'] }"));
  for (const auto& [other, experiment] : {std::pair("target { estimate: 'conductivity' }", gas),
                                          {"target { estimate: 'unknown' }", gas},
                                          {rate.c_str(), steady},
                                          {rate.c_str(), unknown}}) {
    EXPECT_NE(all_of(experiment + other), all_of(experiment)) << experiment << other;
  }
}

// ---- the same request ----

// The simulation tests that a retry returns the original job, also after a restart.
TEST_F(AcceptanceTest, ARequestIdIsForOneRequestOfItsPrincipal) {
  const auto reused = IsError(absl::StatusCode::kInvalidArgument, "REQUEST_ID_REUSED");
  const std::string made = Id(kAnn, CreateRequest(Question(kHeldSeed), kUuid));
  std::vector<v1::CreateEnsembleJobRequest> others(3, CreateRequest(Question(kHeldSeed), kUuid));
  others[0].mutable_spec()->set_seed(2);
  others[1].set_fresh(true);
  others[2].set_priority(1);
  for (const auto& other : others) EXPECT_THAT(Create(kAnn, other), reused);
  EXPECT_THAT(book_->Cancel(kAnn, made, kUuid), reused);
  const std::string cancelled = Id(kAnn, FreshRequest(Question(kHeldSeed)));
  for (int replay = 0; replay < 2; ++replay) EXPECT_OK(book_->Cancel(kAnn, cancelled, kOtherUuid));
  EXPECT_THAT(book_->Cancel(kAnn, made, kOtherUuid), reused);
  EXPECT_THAT(Create(kAnn, CreateRequest(Question(), kOtherUuid)), reused);
  EXPECT_EQ(Id(kAnn, CreateRequest(Question(kHeldSeed), kUuid)), made);
  const std::string bens = Id(kBen, CreateRequest(Question(2), kUuid));
  EXPECT_EQ(Id(kBen, CreateRequest(Question(2), kUuid)), bens);
  EXPECT_THAT(book_->Get(kAnn, bens), StatusIs(absl::StatusCode::kNotFound));
}

TEST_F(AcceptanceTest, ARetryAndAnAnswerFromTheStoreAddLabelsToTheEarlierJob) {
  const auto request = CreateRequest(Question(), kUuid);
  const std::string id = Answered(kAnn, Labelled(request, "figure", "3"));
  EXPECT_EQ(Id(kAnn, Labelled(request, "figure", "4")), id);  // a retry
  EXPECT_EQ(Id(kAnn, Labelled(request, "paper", "yes")), id);
  EXPECT_EQ(Id(kAnn, Labelled(CreateRequest(Question()), "talk", "no")), id);  // an answer
  EXPECT_THAT(Get(id).labels(),
              UnorderedElementsAre(Pair("figure", "4"), Pair("paper", "yes"), Pair("talk", "no")));
  v1::CreateEnsembleJobRequest too_many = request;
  for (size_t i = 0; i < kMostLabels; ++i) {
    too_many = Labelled(too_many, std::to_string(i), "x");
  }
  EXPECT_THAT(Create(kAnn, too_many), StatusIs(absl::StatusCode::kInvalidArgument,
                                               HasSubstr(" 35; permitted: at most 32")));
  EXPECT_EQ(Get(id).labels_size(), 3);
}

TEST_F(AcceptanceTest, AStoredAnswerKeepsItsLabelsAndIsUsedOnlyIfTheyFit) {
  const auto run = [](const char* number) {
    return Labelled(CreateRequest(Question()), "run", number);
  };
  const std::string first = Answered(kAnn, run("1"));
  const std::string second = Answered(kAnn, run("2"));
  EXPECT_NE(second, first);
  EXPECT_THAT(Get(first).labels(), ElementsAre(Pair("run", "1")));
  EXPECT_EQ(Id(kAnn, run("1")), first);
  EXPECT_EQ(Id(kAnn, run("2")), second);
  EXPECT_EQ(Id(kAnn, CreateRequest(Question())), second);
  // Every question is permitted, whatever labels were given to the jobs before.
  v1::CreateEnsembleJobRequest many = CreateRequest(Question());
  for (size_t i = 0; i < kMostLabels; ++i) many = Labelled(many, std::to_string(i), "x");
  const std::string third = Answered(kAnn, many);
  EXPECT_TRUE(third != first && third != second);
  EXPECT_EQ(Id(kAnn, many), third);
}

// Otherwise the store would grow with every repeated question. A stored answer is valid for one
// engine version only.
TEST_F(AcceptanceTest, OnlyTheRequestThatMadeTheJobIsStored) {
  const std::string id = Answered(kAnn, CreateRequest(Question(), kUuid));
  EXPECT_EQ(Id(kAnn, CreateRequest(Question(), kOtherUuid)), id);
  ExpectComputed(kAnn, CreateRequest(Question(2), kOtherUuid), id);
  const auto job =
      ReadFrom(*store_, [&](Database& database) { return FindJob(database, id, Grid::kLeftOut); });
  EXPECT_EQ(job->question, QuestionOf(Question(), EngineVersion()));
}

// ---- limits ----

// Three jobs of ann, of one point each, wait at the gate. A rejected job does not count.
TEST_F(AcceptanceTest, EachLimitNamesItsReasonAndItsFlag) {
  const std::string wait = ": wait until some jobs have ended, or cancel some of yours";
  const std::string split = ": split it between several jobs";
  const struct {
    Limits limits;
    int points;  // of the rejected job
    std::string flag, reason, advice;
  } rows[] = {{{.max_active_jobs_per_principal = 3},
               1,
               "max-active-jobs-per-principal",
               "TOO_MANY_JOBS",
               wait},
              {{.max_active_points_per_principal = 3},
               1,
               "max-active-points-per-principal",
               "TOO_MANY_ACTIVE_POINTS",
               wait},
              {{.max_points_per_job = 3}, 4, "max-points-per-job", "TOO_MANY_POINTS", split}};
  for (const auto& row : rows) {
    Start(row.limits);
    std::vector<std::string> held;
    for (int i = 0; i < 3; ++i)
      held.push_back(Id(kAnn, FreshRequest(Equilibrium(1, 3, kHeldSeed))));
    const auto refused = Create(kAnn, FreshRequest(Equilibrium(row.points, 1), kUuid));
    EXPECT_EQ(ReasonOf(refused), row.reason);
    EXPECT_THAT(refused, StatusIs(absl::StatusCode::kResourceExhausted,
                                  AllOf(HasSubstr("--" + row.flag), HasSubstr(row.advice))));
    EXPECT_THAT(MetadataOf(refused),
                UnorderedElementsAre(Pair("flag", row.flag), Pair("limit", "3")));
    for (const std::string& id : held) {
      ASSERT_OK(book_->Cancel(kAnn, id, ""));
      AwaitEnd(id);
    }
    // There is room now, and no job was created with the id.
    ASSERT_OK(book_->Delete(kAnn, Answered(kAnn, FreshRequest(Equilibrium(1, 1), kUuid))));
  }
}

TEST_F(AcceptanceTest, RetriesAndStoredAnswersIgnoreALowerLimit) {
  const std::string answered = Answered(kAnn, CreateRequest(Question(), kUuid));
  Start({.max_active_jobs_per_principal = 1, .max_points_per_job = 1});
  Id(kAnn, FreshRequest(Equilibrium(1, 5, kHeldSeed)));
  EXPECT_EQ(Id(kAnn, CreateRequest(Question(), kUuid)), answered);
  EXPECT_EQ(Id(kAnn, CreateRequest(Question())), answered);
  // Another request with the same id is rejected because of the id.
  EXPECT_EQ(ReasonOf(Create(kAnn, CreateRequest(Question(3), kUuid))), "REQUEST_ID_REUSED");
  EXPECT_EQ(ReasonOf(Create(kAnn, FreshRequest(Question()))), "TOO_MANY_POINTS");
}

TEST_F(AcceptanceTest, ZeroMeansUnlimited) {
  Start({.max_active_jobs_per_principal = 0,
         .max_active_points_per_principal = 0,
         .max_points_per_job = 0});
  for (int i = 0; i < 5; ++i) EXPECT_OK(Create(kAnn, FreshRequest(Equilibrium(50, 1000))));
}

}  // namespace
}  // namespace ballpiston::server
