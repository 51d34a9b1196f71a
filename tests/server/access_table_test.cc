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
#include "tests/server/running_server.h"
#include "tests/server/secure_server.h"

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
       std::filesystem::directory_iterator(std::string(BALLPISTON_PROTO_DIR) + "/" + folder)) {
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
