// Every method of every service, called with every kind of credential: a table.
#include <cstdlib>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>

#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "ballpiston/v1/server.pb.h"
#include "gmock/gmock.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/dynamic_message.h"
#include "grpcpp/create_channel.h"
#include "gtest/gtest.h"
#include "tests/server/call_by_name.h"
#include "tests/support/running_server.h"
#include "tests/server/secure_server.h"
#include "tests/support/paths.h"

namespace ballpiston::server {
namespace {

using google::protobuf::DescriptorPool;
using google::protobuf::MethodDescriptor;

// What each method needs at least. A new method has to be entered here: the test fails until it is.
const std::map<std::string, Role>& LeastRoles() {
  static const auto* const roles = new std::map<std::string, Role>{
      {"CreateEnsembleJob", Role::kSubmit}, {"GetEnsembleJob", Role::kRead},
      {"ListEnsembleJobs", Role::kRead},    {"CancelEnsembleJob", Role::kSubmit},
      {"DeleteEnsembleJob", Role::kSubmit}, {"WatchEnsembleJob", Role::kRead},
      {"PlanEnsembleJob", Role::kRead},     {"ListResults", Role::kRead},
      {"EvaluatePairs", Role::kRead},       {"CompareMethods", Role::kSubmit},
      {"GetServerStatus", Role::kRead}};
  return *roles;
}

// Of every proto file of the API, as the source tree has them.
std::vector<const MethodDescriptor*> AllMethods() {
  v1::GetServerStatusRequest::descriptor();  // links the file that nothing else here names
  std::vector<const MethodDescriptor*> methods;
  const std::string folder = "ballpiston/v1/";
  for (const auto& entry :
       std::filesystem::directory_iterator(SourcePath("proto/") + folder)) {
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

// Empty but for the job's name, where there is one.
std::string RequestFor(const MethodDescriptor& method, const std::string& job) {
  google::protobuf::DynamicMessageFactory factory;
  const std::unique_ptr<google::protobuf::Message> request(
      factory.GetPrototype(method.input_type())->New());
  const auto* field = JobField(method);
  if (field != nullptr) request->GetReflection()->SetString(request.get(), field, job);
  return request->SerializeAsString();
}

std::string PathOf(const MethodDescriptor& method) {
  return "/" + method.service()->full_name() + "/" + method.name();
}

std::string TextOf(const grpc::Status& status) {
  if (status.ok()) return "OK";
  const std::string reason = DetailsOf(status).reason;
  return reason.empty()
             ? "code " + std::to_string(status.error_code()) + " " + status.error_message()
             : reason;
}

class AccessTable : public ::testing::Test {
 protected:
  // A job of alice's that has ended.
  std::string JobOfAlice() {
    grpc::ClientContext context;
    context.AddMetadata("authorization", std::string("Bearer ") + kAlice);
    v1::CreateEnsembleJobRequest request;
    *request.mutable_spec() = Equilibrium(1, 2);
    request.mutable_spec()->set_seed(++seed_);
    v1::EnsembleJob job;
    const grpc::Status created = stub_->CreateEnsembleJob(&context, request, &job);
    EXPECT_TRUE(created.ok()) << created.error_message();
    v1::WatchEnsembleJobRequest watch;
    watch.set_name(job.name());
    CallByName(channel_, "/ballpiston.v1.EnsembleService/WatchEnsembleJob",
               watch.SerializeAsString(), Bearer(kAlice));
    return job.name();
  }

  std::string Outcome(const MethodDescriptor& method, const std::vector<std::string>& shown) {
    return TextOf(CallByName(channel_, PathOf(method), RequestFor(method, JobOfAlice()), shown));
  }

  LaboratoryFiles files_;
  TemporaryFolder folder_;
  std::unique_ptr<BallpistonServer> server_ =
      *BallpistonServer::Start(SecureOptions(files_.options(), folder_.path()));
  std::shared_ptr<grpc::Channel> channel_ =
      SecureChannel(server_->address(), files_.authority().Pem());
  std::unique_ptr<v1::EnsembleService::Stub> stub_ = v1::EnsembleService::NewStub(channel_);
  uint64_t seed_ = 0;
};

TEST_F(AccessTable, EveryCredentialMayExactlyWhatItsRoleMay) {
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
    // An empty request may be invalid, a job may have ended: that is past the door.
    for (const char* closed : {"ROLE_TOO_LOW", "JOB_NOT_FOUND", "CREDENTIALS_MISSING",
                               "CREDENTIALS_INVALID", "CREDENTIALS_EXPIRED"}) {
      EXPECT_NE(right, closed) << method->name();
    }
    EXPECT_EQ(right.find("code "), std::string::npos) << method->name() << ": " << right;
  }
  std::cout << table.str();
}

TEST_F(AccessTable, AListHoldsOnesOwnJobsAndAnAdminsAll) {
  const std::string job = JobOfAlice();
  const auto listed = [&](const char* token) {
    grpc::ClientContext context;
    context.AddMetadata("authorization", std::string("Bearer ") + token);
    v1::ListEnsembleJobsResponse response;
    const grpc::Status status = stub_->ListEnsembleJobs(&context, {}, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response.jobs_size() == 1 && response.jobs(0).name() == job;
  };
  EXPECT_TRUE(listed(kAlice));
  EXPECT_TRUE(listed(kAliceReads));
  EXPECT_TRUE(listed(kOps));
  EXPECT_FALSE(listed(kBob));
}

// ---- what another principal was given: tokens and request ids ----

class ForeignTokens : public AccessTable {
 protected:
  static constexpr char kId[] = "123e4567-e89b-12d3-a456-426614174000";

  static void Show(grpc::ClientContext& context, const char* token) {
    context.AddMetadata("authorization", std::string("Bearer ") + token);
  }

  v1::EnsembleJob Create(const char* token, const v1::CreateEnsembleJobRequest& request) {
    grpc::ClientContext context;
    Show(context, token);
    v1::EnsembleJob job;
    const grpc::Status status = stub_->CreateEnsembleJob(&context, request, &job);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return job;
  }

  static v1::CreateEnsembleJobRequest Asking(int points, uint64_t seed, const char* id = "") {
    v1::CreateEnsembleJobRequest request;
    *request.mutable_spec() = Equilibrium(points, 2);
    request.mutable_spec()->set_seed(seed);
    request.set_request_id(id);
    return request;
  }

  // All that is told, and how it ends.
  std::vector<v1::WatchEnsembleJobResponse> Watch(const char* token, const std::string& name,
                                                  const std::string& resume, std::string* end) {
    grpc::ClientContext context;
    Show(context, token);
    v1::WatchEnsembleJobRequest request;
    request.set_name(name);
    request.set_resume_token(resume);
    const auto reader = stub_->WatchEnsembleJob(&context, request);
    std::vector<v1::WatchEnsembleJobResponse> told;
    v1::WatchEnsembleJobResponse message;
    while (reader->Read(&message)) told.push_back(message);
    *end = TextOf(reader->Finish());
    return told;
  }

  std::string EndedJob(const char* token, int points, uint64_t seed) {
    const std::string name = Create(token, Asking(points, seed)).name();
    std::string end;
    Watch(token, name, "", &end);
    EXPECT_EQ(end, "OK");
    return name;
  }

  v1::ListEnsembleJobsResponse List(const char* token, const std::string& page) {
    grpc::ClientContext context;
    Show(context, token);
    v1::ListEnsembleJobsRequest request;
    request.set_page_size(1);
    request.set_page_token(page);
    v1::ListEnsembleJobsResponse response;
    const grpc::Status status = stub_->ListEnsembleJobs(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }

  std::string Results(const char* token, const std::string& job, const std::string& page,
                      v1::ListResultsResponse* response) {
    grpc::ClientContext context;
    Show(context, token);
    v1::ListResultsRequest request;
    request.set_parent(job);
    request.set_page_size(1);
    request.set_page_token(page);
    return TextOf(stub_->ListResults(&context, request, response));
  }
};

TEST_F(ForeignTokens, APageOfAnothersListIsAPageOfOnesOwn) {
  const std::string bobs = EndedJob(kBob, 1, 1);
  for (uint64_t seed = 1; seed < 3; ++seed) EndedJob(kAlice, 1, seed);
  const std::string page = List(kAlice, "").next_page_token();
  ASSERT_FALSE(page.empty());
  const v1::ListEnsembleJobsResponse seen = List(kBob, page);
  ASSERT_EQ(seen.jobs_size(), 1);
  EXPECT_EQ(seen.jobs(0).name(), bobs);
  EXPECT_EQ(seen.next_page_token(), "");
}

TEST_F(ForeignTokens, APageOfAnothersResultsIsNone) {
  const std::string alices = EndedJob(kAlice, 2, 1), bobs = EndedJob(kBob, 2, 1);
  v1::ListResultsResponse page, seen;
  ASSERT_EQ(Results(kAlice, alices, "", &page), "OK");
  ASSERT_FALSE(page.next_page_token().empty());
  EXPECT_EQ(Results(kBob, alices, page.next_page_token(), &seen), "JOB_NOT_FOUND");
  EXPECT_EQ(Results(kBob, bobs, page.next_page_token(), &seen), "INVALID_REQUEST");
  EXPECT_EQ(seen.points_size(), 0);
  EXPECT_EQ(Results(kOps, alices, page.next_page_token(), &seen), "OK");
  EXPECT_EQ(seen.points(0).index(), 1);
}

TEST_F(ForeignTokens, AnothersResumeTokenIsAsGoodAsNone) {
  const std::string alices = EndedJob(kAlice, 3, 1), bobs = EndedJob(kBob, 3, 1);
  std::string end;
  const std::string resume = Watch(kAlice, alices, "", &end).back().resume_token();
  EXPECT_TRUE(Watch(kBob, alices, resume, &end).empty());
  EXPECT_EQ(end, "JOB_NOT_FOUND");
  const auto told = Watch(kBob, bobs, resume, &end);
  EXPECT_EQ(end, "OK");
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told[0].snapshot().finished_points_size(), 3);
  EXPECT_EQ(told.back().job().name(), bobs);
}

TEST_F(ForeignTokens, AnothersRequestIdMakesAJobOfOnesOwn) {
  const std::string alices = Create(kAlice, Asking(1, 1, kId)).name();
  const v1::EnsembleJob same = Create(kBob, Asking(1, 1, kId));
  EXPECT_NE(same.name(), alices);
  EXPECT_EQ(same.principal(), "bob");
  EXPECT_FALSE(same.answered_from_store());
  // And an administrator, who may see both, makes a third, of another question.
  const v1::EnsembleJob third = Create(kOps, Asking(1, 2, kId));
  EXPECT_NE(third.name(), alices);
  EXPECT_EQ(third.principal(), "ops");
}

TEST_F(ForeignTokens, AnothersCancellationCannotBeRepeated) {
  v1::CreateEnsembleJobRequest endless = Asking(1, 1);
  endless.mutable_spec()->mutable_target()->set_collisions(1'000'000'000);
  const std::string alices = Create(kAlice, endless).name();
  const auto cancel = [&](const char* token) {
    grpc::ClientContext context;
    Show(context, token);
    v1::CancelEnsembleJobRequest request;
    request.set_name(alices);
    request.set_request_id(kId);
    v1::EnsembleJob job;
    const std::string outcome = TextOf(stub_->CancelEnsembleJob(&context, request, &job));
    return outcome + " " + job.name();
  };
  EXPECT_EQ(cancel(kBob), "JOB_NOT_FOUND ");
  EXPECT_EQ(cancel(kAlice), "OK " + alices);
  EXPECT_EQ(cancel(kBob), "JOB_NOT_FOUND ");
  EXPECT_EQ(cancel(kAlice), "OK " + alices);  // a replay
}

TEST_F(AccessTable, HeadersThatAreNotOneBearerTokenAreInvalid) {
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

// An empty request of health's Check asks for the whole server; field 7 of a reflection request
// lists the services.
TEST_F(AccessTable, HealthIsOpenAndReflectionIsNot) {
  const std::string health = "/grpc.health.v1.Health/Check";
  const std::string reflection = "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";
  const std::string list_services = "\x3a\x01*";
  EXPECT_TRUE(CallByName(channel_, health, "", {}).ok());
  for (const auto& shown : {Bearer(""), Bearer("no-such-token"), Bearer(kAliceOnce)}) {
    EXPECT_EQ(CallByName(channel_, reflection, list_services, shown).error_code(),
              grpc::StatusCode::UNAUTHENTICATED);
  }
  const grpc::Status status = CallByName(channel_, reflection, list_services, Bearer(kAliceReads));
  EXPECT_TRUE(status.ok()) << status.error_message();
}

TEST_F(AccessTable, NoErrorHoldsTheTokenThatWasShown) {
  for (const MethodDescriptor* method : AllMethods()) {
    for (const char* token : {"secret-no-such-token", kAliceOnce, kBob, kAliceReads}) {
      const grpc::Status status = CallByName(
          channel_, PathOf(*method), RequestFor(*method, "ensembleJobs/none"), Bearer(token));
      EXPECT_EQ(status.error_message().find(token), std::string::npos) << method->name();
      EXPECT_EQ(status.error_details().find(token), std::string::npos) << method->name();
    }
  }
}

}  // namespace
}  // namespace ballpiston::server
