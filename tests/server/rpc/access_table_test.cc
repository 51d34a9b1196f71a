// Every method of every service, called with every kind of credential: a table.
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "ballpiston/v1/server.pb.h"
#include "gmock/gmock.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/dynamic_message.h"
#include "gtest/gtest.h"
#include "tests/server/call_by_name.h"
#include "tests/server/error_details.h"
#include "tests/server/requests.h"
#include "tests/server/rpc/watch_stream.h"
#include "tests/server/running_server.h"
#include "tests/server/secure_server.h"
#include "tests/support/await.h"
#include "tests/support/paths.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using google::protobuf::DescriptorPool;
using google::protobuf::MethodDescriptor;

// The least role of each method. A new method must be added here, or the test fails.
const std::map<std::string, Role>& LeastRoles() {
  static const auto* const roles = new std::map<std::string, Role>{
      {"CreateEnsembleJob", Role::kSubmit}, {"GetEnsembleJob", Role::kRead},
      {"ListEnsembleJobs", Role::kRead},    {"CancelEnsembleJob", Role::kSubmit},
      {"DeleteEnsembleJob", Role::kSubmit}, {"WatchEnsembleJob", Role::kRead},
      {"PlanEnsembleJob", Role::kRead},     {"ListResults", Role::kRead},
      {"UpdateEnsembleJob", Role::kSubmit}, {"GetResult", Role::kRead},
      {"EvaluatePairs", Role::kRead},       {"GetServerStatus", Role::kRead},
      {"TraceOrbit", Role::kSubmit},        {"SampleCollisions", Role::kSubmit}};
  return *roles;
}

// The methods of all proto files of the API in the source tree.
std::vector<const MethodDescriptor*> AllMethods() {
  // Links the proto files that no other code here uses.
  v1::GetServerStatusRequest::descriptor();
  std::vector<const MethodDescriptor*> methods;
  const std::string folder = "ballpiston/v1/";
  for (const auto& entry : std::filesystem::directory_iterator(SourcePath("proto/") + folder)) {
    const std::string name = folder + entry.path().filename().string();
    const auto* file = DescriptorPool::generated_pool()->FindFileByName(name);
    if (entry.path().extension() != ".proto") continue;
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
  google::protobuf::DynamicMessageFactory factory;
  const std::unique_ptr<google::protobuf::Message> request(
      factory.GetPrototype(method.input_type())->New());
  const auto* field = JobField(method);
  const std::string name = method.name() == "GetResult" ? job + "/results/0" : job;
  if (field != nullptr) request->GetReflection()->SetString(request.get(), field, name);
  return request->SerializeAsString();
}

std::string PathOf(const MethodDescriptor& method) {
  return "/" + method.service()->full_name() + "/" + method.name();
}

std::string TextOf(const grpc::Status& status) {
  if (status.ok()) return "OK";
  const std::string reason = ReasonOf(status);
  return reason.empty()
             ? "code " + std::to_string(status.error_code()) + " " + status.error_message()
             : reason;
}

class AccessTable : public ::testing::Test {
 protected:
  TestClient ClientWith(const char* token) const {
    return TestClient(server_.NewChannel(files_.Credentials(token)));
  }

  static std::string EndedJob(TestClient& client, int points) {
    const std::string name = client.Submit(Equilibrium(points, 2));
    client.AwaitEnd(name);
    return name;
  }
  std::string JobOfAlice() { return EndedJob(alice_, 1); }

  // `shown` holds the authorization headers.
  std::string Outcome(const MethodDescriptor& method, const std::vector<std::string>& shown) {
    return TextOf(
        CallByName(server_.channel(), PathOf(method), RequestFor(method, JobOfAlice()), shown));
  }

  LaboratoryFiles files_;
  RunningServer server_{Secure(files_)};
  TestClient alice_ = ClientWith(kAlice);
  TestClient bob_ = ClientWith(kBob);
  TestClient ops_ = ClientWith(kOps);
};

TEST_F(AccessTable, EveryCredentialHasExactlyTheRightsOfItsRole) {
  std::ostringstream table;
  const auto row = [&](const std::vector<std::string>& cells) {
    table << std::left << std::setw(20) << cells[0];
    for (size_t i = 1; i < cells.size(); ++i) table << std::setw(22) << cells[i];
    table << "\n";
  };
  row({"method", "no", "bad", "expired", "foreign", "read-only", "right", "admin"});
  const auto methods = AllMethods();
  EXPECT_GE(methods.size(), 10u);
  for (const MethodDescriptor* method : methods) {
    ASSERT_EQ(LeastRoles().count(method->name()), 1u) << method->name() << " has no role";
    const Role least = LeastRoles().at(method->name());
    const bool of_a_job = JobField(*method) != nullptr;
    const std::string no = Outcome(*method, {});
    const std::string bad = Outcome(*method, Bearer("no-such-token"));
    const std::string expired = Outcome(*method, Bearer(kAliceOnce));
    const std::string foreign = Outcome(*method, Bearer(kBob));
    const std::string reads = Outcome(*method, Bearer(kAliceReads));
    const std::string right = Outcome(*method, Bearer(kAlice));
    const std::string admin = Outcome(*method, Bearer(kOps));
    row({method->name(), no, bad, expired, foreign, reads, right, admin});
    EXPECT_EQ(no, "CREDENTIALS_MISSING") << method->name();
    EXPECT_EQ(bad, "CREDENTIALS_INVALID") << method->name();
    EXPECT_EQ(expired, "CREDENTIALS_EXPIRED") << method->name();
    EXPECT_EQ(foreign, of_a_job ? "JOB_NOT_FOUND" : right) << method->name();
    EXPECT_EQ(reads, least == Role::kRead ? right : "ROLE_TOO_LOW") << method->name();
    EXPECT_EQ(admin, right) << method->name();
    // Other errors (an invalid request, an ended job) come after authorisation.
    for (const char* closed : {"ROLE_TOO_LOW", "JOB_NOT_FOUND", "CREDENTIALS_MISSING",
                               "CREDENTIALS_INVALID", "CREDENTIALS_EXPIRED"}) {
      EXPECT_NE(right, closed) << method->name();
    }
    EXPECT_EQ(right.find("code "), std::string::npos) << method->name() << ": " << right;
  }
  std::cout << table.str();
}

TEST_F(AccessTable, ListsHoldOwnJobsAndAnAdministratorsAll) {
  const std::string job = JobOfAlice();
  TestClient reader = ClientWith(kAliceReads);
  for (TestClient* client : {&alice_, &reader, &ops_}) {
    const v1::ListEnsembleJobsResponse list = client->List();
    ASSERT_EQ(list.jobs_size(), 1);
    EXPECT_EQ(list.jobs(0).name(), job);
  }
  EXPECT_EQ(bob_.List().jobs_size(), 0);
}

TEST_F(AccessTable, UnfinishedResultsBelongToThePrincipalOfTheJob) {
  const std::string job = alice_.Submit(Equilibrium(1, 1'000'000'000'000));
  v1::GetResultRequest request;
  request.set_name(job + "/results/0");
  request.set_unfinished(true);
  const auto get = [&request](TestClient& client) {
    grpc::ClientContext context;
    v1::PointResult now;
    return client.ensemble().GetResult(&context, request, &now);
  };
  AwaitThat([&] {  // until a worker has computed a part
    EXPECT_EQ(ReasonOf(get(bob_)), "JOB_NOT_FOUND");
    return get(alice_).ok() || HasFailure();
  });
  EXPECT_EQ(ReasonOf(get(bob_)), "JOB_NOT_FOUND");
  EXPECT_OK(get(ops_));
}

// ---- tokens and request ids of another principal ----

class ForeignTokens : public AccessTable {
 protected:
  static v1::ListEnsembleJobsResponse FirstJobOf(TestClient& client, const std::string& page) {
    v1::ListEnsembleJobsRequest request;
    request.set_page_size(1);
    request.set_page_token(page);
    return client.List(request);
  }

  static grpc::Status FirstResult(TestClient& client, const std::string& job,
                                  const std::string& page, v1::ListResultsResponse* response) {
    grpc::ClientContext context;
    v1::ListResultsRequest request;
    request.set_parent(job);
    request.set_page_size(1);
    request.set_page_token(page);
    return client.ensemble().ListResults(&context, request, response);
  }
};

TEST_F(ForeignTokens, PageTokensOfAnothersListShowOwnJobs) {
  const std::string bobs = EndedJob(bob_, 1);
  for (int i = 0; i < 2; ++i) EndedJob(alice_, 1);
  const std::string page = FirstJobOf(alice_, "").next_page_token();
  ASSERT_FALSE(page.empty());
  const v1::ListEnsembleJobsResponse seen = FirstJobOf(bob_, page);
  ASSERT_EQ(seen.jobs_size(), 1);
  EXPECT_EQ(seen.jobs(0).name(), bobs);
  EXPECT_EQ(seen.next_page_token(), "");
}

TEST_F(ForeignTokens, PageTokensOfAnothersResultsAreRefused) {
  const std::string alices = EndedJob(alice_, 2), bobs = EndedJob(bob_, 2);
  v1::ListResultsResponse page, seen;
  ASSERT_OK(FirstResult(alice_, alices, "", &page));
  const std::string next = page.next_page_token();
  ASSERT_FALSE(next.empty());
  EXPECT_EQ(ReasonOf(FirstResult(bob_, alices, next, &seen)), "JOB_NOT_FOUND");
  EXPECT_EQ(ReasonOf(FirstResult(bob_, bobs, next, &seen)), "INVALID_REQUEST");
  EXPECT_EQ(seen.results_size(), 0);
  EXPECT_OK(FirstResult(ops_, alices, next, &seen));
  EXPECT_EQ(seen.results(0).name(), alices + "/results/1");
}

TEST_F(ForeignTokens, ResumeTokensOfAnothersWatchSkipNothing) {
  const std::string alices = EndedJob(alice_, 3), bobs = EndedJob(bob_, 3);
  const std::string resume = WatchStream(alice_, alices).ToTheEnd().back().resume_token();
  WatchStream foreign(bob_, alices, resume);
  EXPECT_FALSE(foreign.Next());
  EXPECT_EQ(ReasonOf(foreign.End()), "JOB_NOT_FOUND");
  WatchStream own(bob_, bobs, resume);
  const std::vector<WatchMessage> told = own.ToTheEnd();
  EXPECT_OK(own.End());
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told[0].snapshot().finished_points_size(), 3);
  EXPECT_EQ(told.back().job().name(), bobs);
}

TEST_F(ForeignTokens, EachPrincipalHasItsOwnRequestIds) {
  const std::string alices = alice_.Created(CreateRequest(Equilibrium(1, 2), kUuid)).name();
  const v1::EnsembleJob same = bob_.Created(CreateRequest(Equilibrium(1, 2), kUuid));
  EXPECT_NE(same.name(), alices);
  EXPECT_EQ(same.principal(), "bob");
  EXPECT_FALSE(same.answered_from_store());
  // An administrator, who may see both, creates a third job with another question.
  const v1::EnsembleJob third = ops_.Created(CreateRequest(Equilibrium(1, 2, 2), kUuid));
  EXPECT_NE(third.name(), alices);
  EXPECT_EQ(third.principal(), "ops");
}

TEST_F(ForeignTokens, AnothersCancellationCannotBeRepeated) {
  const std::string alices = alice_.Submit(Equilibrium(1, 1'000'000'000));
  EXPECT_EQ(ReasonOf(bob_.Cancel(alices, kUuid)), "JOB_NOT_FOUND");
  EXPECT_OK(alice_.Cancel(alices, kUuid));
  EXPECT_EQ(ReasonOf(bob_.Cancel(alices, kUuid)), "JOB_NOT_FOUND");
  EXPECT_OK(alice_.Cancel(alices, kUuid));  // a retry
}

TEST_F(AccessTable, HeadersOtherThanOneBearerTokenAreInvalid) {
  const MethodDescriptor& list = *DescriptorPool::generated_pool()->FindMethodByName(
      "ballpiston.v1.EnsembleService.ListEnsembleJobs");
  const std::string right = std::string("Bearer ") + kAlice;
  EXPECT_EQ(Outcome(list, {right}), "OK");
  EXPECT_EQ(Outcome(list, {std::string("bearer ") + kAlice}), "OK");
  const std::vector<std::vector<std::string>> wrong = {{right, right},
                                                       {right, "Bearer x"},
                                                       {kAlice},
                                                       {std::string("Basic ") + kAlice},
                                                       {"Bearer "},
                                                       {right + "x"},
                                                       {"Bearer"},
                                                       {""},
                                                       {"Bearer  " + right.substr(7)},
                                                       {"Bearer " + std::string(5000, 'x')}};
  for (const auto& shown : wrong) {
    EXPECT_EQ(Outcome(list, shown), "CREDENTIALS_INVALID") << shown[0].substr(0, 50);
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

// Another user of the machine, who cannot read the token of the server's user.
TEST(LoopbackAccess, EveryMethodExceptHealthNeedsAToken) {
  RunningServer server({.listen = "127.0.0.1:0"});
  std::vector<std::string> paths = {kReflection};
  for (const MethodDescriptor* method : AllMethods()) paths.push_back(PathOf(*method));
  for (const std::string& path : paths) {
    EXPECT_THAT(CallByName(server.channel(), path), StatusIs(grpc::StatusCode::UNAUTHENTICATED))
        << path;
  }
  EXPECT_OK(CallByName(server.channel(), kCheckHealth));
}

TEST_F(AccessTable, ErrorsNeverHoldTheToken) {
  for (const MethodDescriptor* method : AllMethods()) {
    for (const char* token : {"secret-no-such-token", kAliceOnce, kBob, kAliceReads}) {
      const grpc::Status status =
          CallByName(server_.channel(), PathOf(*method), RequestFor(*method, "ensembleJobs/none"),
                     Bearer(token));
      EXPECT_EQ(status.error_message().find(token), std::string::npos) << method->name();
      EXPECT_EQ(status.error_details().find(token), std::string::npos) << method->name();
    }
  }
}

}  // namespace
}  // namespace ballpiston::server
