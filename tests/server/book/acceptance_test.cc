// The outcome of one Create: a new job, an earlier one, or an error.
#include "server/book/acceptance.h"

#include "tests/server/book/book_test.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

v1::EnsembleSpec Question(uint64_t seed = 1) { return Equilibrium(2, 5, seed); }

class AcceptanceTest : public BookTest {
 protected:
  // Expects that the request creates a new job.
  void ExpectComputed(const Principal& caller, const v1::CreateEnsembleJobRequest& request,
                      const std::string& earlier) {
    ASSERT_OK_AND_ASSIGN(const auto job, Create(caller, request));
    EXPECT_NE(job.name(), JobName(earlier));
    EXPECT_FALSE(job.answered_from_store());
  }

  // With three jobs of ann that wait at the gate, of one point each, her request is refused because
  // of the limit of 3.
  void ExpectLimit(const Limits& limits, const std::string& reason, const std::string& flag,
                   const std::string& advice,
                   const v1::EnsembleSpec& refused_spec = Equilibrium(1, 1)) {
    SCOPED_TRACE(flag);
    const std::string request_id =
        "123e4567-e89b-12d3-a456-42661417400" + std::to_string(checked_++);
    Start(limits);
    std::vector<std::string> held;
    for (int i = 0; i < 3; ++i)
      held.push_back(Id(kAnn, FreshRequest(Equilibrium(1, 3, kHeldSeed))));
    for (int repeated = 0; repeated < 2; ++repeated) {  // a refused job does not count
      const auto refused = Create(kAnn, FreshRequest(refused_spec, request_id));
      EXPECT_THAT(refused, IsError(absl::StatusCode::kResourceExhausted, reason));
      EXPECT_THAT(std::string(refused.status().message()),
                  AllOf(HasSubstr("--" + flag), HasSubstr(": " + advice)));
      const ErrorDetails details = DetailsOf(refused.status());
      EXPECT_EQ(details.domain, "ballpiston");
      EXPECT_EQ(details.metadata.at("flag"), flag);
      EXPECT_EQ(details.metadata.at("limit"), "3");
    }
    for (const std::string& id : held) {
      ASSERT_OK(book_->Cancel(kAnn, id, ""));
      AwaitEnd(id);
    }
    // There is room now, and no job was created with the id.
    AwaitEnd(Id(kAnn, FreshRequest(Equilibrium(1, 1), request_id)));
  }

 private:
  int checked_ = 0;
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

TEST_F(AcceptanceTest, AnotherQuestionAndAFreshAnswerAreComputed) {
  const std::string first = Answered(kAnn, CreateRequest(Question()));
  ExpectComputed(kAnn, FreshRequest(Question()), first);
  ExpectComputed(kAnn, CreateRequest(Question(2)), first);
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
    record.question = QuestionOf(Question(), engine);
    record.job.set_principal(kAnn.name);
    *record.job.mutable_spec() = Question();
    record.job.set_engine_version(engine);
    record.job.mutable_progress()->set_points(2);
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

TEST(Question, EveryFieldOfTheSpecificationIsPartOfIt) {
  v1::EnsembleSpec spec = Question();
  std::map<std::string, std::string> fields = {{QuestionOf(spec, "1"), "none"}};
  ChangeEachField(spec, [&](const FieldDescriptor& field) {
    const std::string question = QuestionOf(spec, "1");
    if (spec.target().has_budget()) {
      EXPECT_EQ(question, "") << field.full_name();  // it has no answer
      return;
    }
    EXPECT_NE(question, "");
    const auto [same, is_new] = fields.emplace(question, field.full_name());
    EXPECT_TRUE(is_new) << field.full_name() << " makes the same question as " << same->second;
  });
  EXPECT_GE(fields.size(), 15u);
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

TEST(Question, DefaultValuesMayBeNamedOrLeftOutAndColumnsHaveNoOrder) {
  v1::EnsembleSpec named = Question();
  named.set_model(v1::EnsembleSpec::AUTO);
  named.set_precision(v1::EnsembleSpec::DOUBLE);
  named.mutable_target()->set_samples(kDefaultSamples);
  for (const char* column : {"rho", "delta"}) named.mutable_grid()->add_table(column);
  v1::EnsembleSpec left_out = named;
  left_out.mutable_grid()->mutable_table()->SwapElements(0, 1);
  left_out.clear_model();
  left_out.clear_precision();
  left_out.clear_target();
  EXPECT_EQ(QuestionOf(named, "1"), QuestionOf(left_out, "1"));
  EXPECT_EQ(FamilyOf(named, "1"), FamilyOf(left_out, "1"));
  EXPECT_EQ(PayloadOf(CreateRequest(named, kUuid)), PayloadOf(CreateRequest(left_out, kUuid)));
}

// A retry may have other labels: they are added to the job.
TEST(Payload, EveryFieldExceptTheIdAndTheLabelsIsPartOfTheHash) {
  v1::CreateEnsembleJobRequest request = CreateRequest(Question(), kUuid);
  const std::string payload = PayloadOf(request);
  std::map<std::string, std::string> fields = {{payload, "none"}};
  ChangeEachField(request, [&](const FieldDescriptor& field) {
    if (field.name() == "request_id") {
      EXPECT_EQ(PayloadOf(request), payload);
      return;
    }
    const auto [same, is_new] = fields.emplace(PayloadOf(request), field.full_name());
    EXPECT_TRUE(is_new) << field.full_name() << " makes the same payload as " << same->second;
  });
  EXPECT_GE(fields.size(), 18u);
}

// ---- the same request ----

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
    Start();
  }
  EXPECT_EQ(List(Query(), kRoot).jobs.size(), 1u);
}

TEST_F(AcceptanceTest, ARequestIdOfACancellationIsNotThatOfAnotherRequest) {
  const std::string made = Id(kAnn, CreateRequest(Question(kHeldSeed), kUuid));
  const std::string id = "123e4567-e89b-12d3-a456-426614174009";
  const auto reused = IsError(absl::StatusCode::kInvalidArgument, "REQUEST_ID_REUSED");
  EXPECT_THAT(book_->Cancel(kAnn, made, kUuid), reused);
  const std::string cancelled = Id(kAnn, FreshRequest(Question(kHeldSeed)));
  for (int replay = 0; replay < 2; ++replay) EXPECT_OK(book_->Cancel(kAnn, cancelled, id));
  EXPECT_THAT(book_->Cancel(kAnn, made, id), reused);
  EXPECT_THAT(Create(kAnn, CreateRequest(Question(), id)), reused);
  EXPECT_EQ(Id(kAnn, CreateRequest(Question(kHeldSeed), kUuid)), made);
}

v1::CreateEnsembleJobRequest Labelled(v1::CreateEnsembleJobRequest request, const std::string& key,
                                      const std::string& value) {
  (*request.mutable_labels())[key] = value;
  return request;
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

TEST_F(AcceptanceTest, EachPrincipalHasItsOwnRequestIds) {
  const std::string anns = Id(kAnn, CreateRequest(Question(), kUuid));
  const std::string bens = Id(kBen, CreateRequest(Question(2), kUuid));
  EXPECT_NE(anns, bens);
  EXPECT_EQ(Id(kBen, CreateRequest(Question(2), kUuid)), bens);
  EXPECT_THAT(book_->Get(kAnn, bens), StatusIs(absl::StatusCode::kNotFound));
}

// Otherwise the store would grow each time a question is asked again.
TEST_F(AcceptanceTest, OnlyTheRequestThatMadeTheJobIsStored) {
  const std::string id = Answered(kAnn, CreateRequest(Question(), kUuid));
  for (int repeated = 0; repeated < 2; ++repeated) {
    ASSERT_OK_AND_ASSIGN(const auto again, Create(kAnn, CreateRequest(Question(), kOtherUuid)));
    EXPECT_EQ(again.name(), JobName(id));
    EXPECT_TRUE(again.answered_from_store());
  }
  const auto requests = ReadFrom(*store_, [](Database& database) {
    return database.All<std::string>("SELECT request_id FROM jobs");
  });
  EXPECT_THAT(requests, ElementsAre(kUuid));
}

// ---- limits ----

TEST_F(AcceptanceTest, EachLimitNamesItsReasonAndItsFlag) {
  const std::string wait = "wait until some jobs have ended, or cancel some of yours";
  ExpectLimit({.max_active_jobs_per_principal = 3}, "TOO_MANY_JOBS",
              "max-active-jobs-per-principal", wait);
  ExpectLimit({.max_active_points_per_principal = 3}, "TOO_MANY_ACTIVE_POINTS",
              "max-active-points-per-principal", wait);
  ExpectLimit({.max_points_per_job = 3}, "TOO_MANY_POINTS", "max-points-per-job",
              "split it between several jobs", Equilibrium(4, 1));
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
