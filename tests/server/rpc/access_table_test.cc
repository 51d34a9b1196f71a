// Every method of every service, called with every kind of credential: a table.
#include "ballpiston/v1/server.pb.h"
#include "tests/server/preamble.h"
#include "tests/server/secure_server.h"

namespace ballpiston::server {
namespace {

using google::protobuf::DescriptorPool;
using google::protobuf::MessageFactory;
using google::protobuf::MethodDescriptor;

// The least role of each method. A new method must be added here, or the test fails.
const std::map<std::string, Role> kLeastRoles = {
    {"CreateEnsembleJob", Role::kSubmit}, {"GetEnsembleJob", Role::kRead},
    {"ListEnsembleJobs", Role::kRead},    {"CancelEnsembleJob", Role::kSubmit},
    {"DeleteEnsembleJob", Role::kSubmit}, {"WatchEnsembleJob", Role::kRead},
    {"PlanEnsembleJob", Role::kRead},     {"ListResults", Role::kRead},
    {"UpdateEnsembleJob", Role::kSubmit}, {"GetResult", Role::kRead},
    {"EvaluatePairs", Role::kRead},       {"GetServerStatus", Role::kRead},
    {"TraceOrbit", Role::kSubmit},        {"SampleCollisions", Role::kSubmit}};

// The methods of all proto files of the API in the source tree.
std::vector<const MethodDescriptor*> AllMethods() {
  // Links the proto files that no other code here uses.
  v1::GetServerStatusRequest::descriptor();
  std::vector<const MethodDescriptor*> methods;
  for (const std::string& name : NamesIn(SourcePath("proto/ballpiston/v1"))) {
    if (!name.ends_with(".proto")) continue;
    const auto* file = DescriptorPool::generated_pool()->FindFileByName("ballpiston/v1/" + name);
    EXPECT_NE(file, nullptr) << name << " is not linked";
    for (int i = 0; file != nullptr && i < file->service_count(); ++i) {
      for (int j = 0; j < file->service(i)->method_count(); ++j) {
        methods.push_back(file->service(i)->method(j));
      }
    }
  }
  return methods;
}

const google::protobuf::FieldDescriptor* JobField(const MethodDescriptor& method) {
  const auto* name = method.input_type()->FindFieldByName("name");
  return name != nullptr ? name : method.input_type()->FindFieldByName("parent");
}

// A request that has only the name of the job or of its first result, if the method needs one.
std::string RequestFor(const MethodDescriptor& method, const std::string& job) {
  const std::unique_ptr<google::protobuf::Message> request(
      MessageFactory::generated_factory()->GetPrototype(method.input_type())->New());
  const auto* field = JobField(method);
  const std::string name = method.name() == "GetResult" ? job + "/results/0" : job;
  if (field != nullptr) request->GetReflection()->SetString(request.get(), field, name);
  return request->SerializeAsString();
}

class AccessTable : public ::testing::Test {
 protected:
  // `shown` holds the authorization headers.
  grpc::Status Ask(const MethodDescriptor& method, const std::string& job,
                   const std::vector<std::string>& shown) {
    return CallByName(server_.channel(), PathOf(method), RequestFor(method, job), shown);
  }

  LaboratoryFiles files_;
  RunningServer server_{Secure(files_)};
  TestClient alice_ = TestClient(server_.NewChannel(files_.Credentials(kAlice)));
};

TEST_F(AccessTable, EveryCredentialHasExactlyTheRightsOfItsRole) {
  const auto methods = AllMethods();
  EXPECT_GE(methods.size(), 10u);
  for (const MethodDescriptor* method : methods) {
    ASSERT_EQ(kLeastRoles.count(method->name()), 1u) << method->name() << " has no role";
    const Role least = kLeastRoles.at(method->name());
    const bool of_a_job = JobField(*method) != nullptr;
    SCOPED_TRACE(method->name());
    const auto outcome = [&](const std::string& token) {
      const std::string job = alice_.Succeeded(Equilibrium(1, 2));
      const grpc::Status status = Ask(*method, job, Bearer(token));
      if (!token.empty()) {  // errors never hold it
        EXPECT_THAT(status.error_message(), Not(HasSubstr(token)));
        EXPECT_THAT(status.error_details(), Not(HasSubstr(token)));
      }
      return status.ok() ? "OK" : ReasonOf(status);
    };
    const std::string right = outcome(kAlice);
    EXPECT_EQ(outcome(""), "CREDENTIALS_MISSING");
    EXPECT_EQ(outcome("no-such-token"), "CREDENTIALS_INVALID");
    EXPECT_EQ(outcome(kAliceOnce), "CREDENTIALS_EXPIRED");
    EXPECT_EQ(outcome(kBob), of_a_job ? "JOB_NOT_FOUND" : right);
    EXPECT_EQ(outcome(kAliceReads), least == Role::kRead ? right : "ROLE_TOO_LOW");
    EXPECT_EQ(outcome(kOps), right);
    // Other errors (an invalid request, an ended job) come after authorisation.
    for (const char* closed : {"", "ROLE_TOO_LOW", "JOB_NOT_FOUND", "CREDENTIALS_MISSING",
                               "CREDENTIALS_INVALID", "CREDENTIALS_EXPIRED"}) {
      EXPECT_NE(right, closed);
    }
  }
}

// tests/server/book/job_test.cc tests which names are malformed.
TEST_F(AccessTable, UnknownJobsAreNotFoundAndMalformedNamesInvalid) {
  for (const MethodDescriptor* method : AllMethods()) {
    if (JobField(*method) == nullptr) continue;
    SCOPED_TRACE(method->name());
    const auto call = [&](const std::string& job) { return Ask(*method, job, Bearer(kOps)); };
    EXPECT_THAT(call("ensembleJobs/unknown"),
                IsError(grpc::StatusCode::NOT_FOUND, "JOB_NOT_FOUND"));
    EXPECT_THAT(FieldsOf(call("ensembleJobs/A B")), ElementsAre(JobField(*method)->name()));
  }
}

TEST_F(AccessTable, HeadersOtherThanOneBearerTokenAreInvalid) {
  const auto list = [this](const std::vector<std::string>& shown) {
    return CallByName(server_.channel(), kListJobs, "", shown);
  };
  const std::string right = std::string("Bearer ") + kAlice;
  EXPECT_OK(list({right}));
  EXPECT_OK(list({std::string("bearer ") + kAlice}));
  const std::vector<std::vector<std::string>> wrong = {{right, right},
                                                       {right, "Bearer x"},
                                                       {kAlice},
                                                       {std::string("Basic ") + kAlice},
                                                       {right + "x"},
                                                       {""},
                                                       {"Bearer  " + right.substr(7)},
                                                       {"Bearer " + std::string(5000, 'x')}};
  for (const auto& shown : wrong) {
    EXPECT_EQ(ReasonOf(list(shown)), "CREDENTIALS_INVALID") << shown[0].substr(0, 50);
  }
}

// An empty request of the health service's Check asks for the whole server.
TEST_F(AccessTable, HealthNeedsNoTokenAndReflectionDoes) {
  EXPECT_OK(CallByName(server_.channel(), kCheckHealth));
  for (const auto& shown : {Bearer(""), Bearer("no-such-token"), Bearer(kAliceOnce)}) {
    EXPECT_THAT(CallByName(server_.channel(), kReflection, kListServices, shown),
                StatusIs(grpc::StatusCode::UNAUTHENTICATED));
  }
  EXPECT_OK(CallByName(server_.channel(), kReflection, kListServices, Bearer(kAliceReads)));
}

}  // namespace
}  // namespace ballpiston::server
