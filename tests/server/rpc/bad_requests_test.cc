// Bad requests of all methods: the error names the fields and says what is permitted. All ranges of
// a specification are in tests/core/ensemble/ensemble_spec_test.cc, its texts in
// convert/spec_test.cc.
#include "server/rpc/request_check.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

using Fields = std::vector<std::string>;

const char kAndMore[] = "...";

struct BadRequest {
  std::string method;        // of version 1 of the API
  std::string request;       // in text format; a later value replaces an earlier one or is added
  Fields fields;             // that the error names; kAndMore: and others
  std::string message = {};  // a part of it
};

std::string Times(int count, const std::string& text) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

// The token of a page of the list that this request begins.
template <typename Request>
std::string PageToken(const Request& list, int64_t start) {
  return "page_token: '" + NextPageToken(list, start) + "'";
}

std::vector<BadRequest> BadRequests() {
  const std::string create = "CreateEnsembleJob", update = "UpdateEnsembleJob";
  const std::string list = "ListEnsembleJobs", results = "ListResults", pairs = "EvaluatePairs";
  const std::string trace = "TraceOrbit", sample = "SampleCollisions";
  v1::ListEnsembleJobsRequest other_jobs;
  other_jobs.add_states(v1::EnsembleJob::RUNNING);
  v1::ListResultsRequest other_results;
  other_results.set_parent("ensembleJobs/b");
  const std::string hit =
      "spec { experiment: FIRST_HIT target { samples: 64 } "
      "grid { rho: 0.53 delta: [0.3, 0.25, 0.2] epsilon: [0.1, 0.4] exponent: 1 } } ";
  const auto with = [&hit](const std::string& change) { return hit + "spec { " + change + " }"; };
  const std::string mask = "permitted: pinned, priority";
  const std::string job = "job { name: 'ensembleJobs/a' } ";
  const std::string of_job = "parent: 'ensembleJobs/a' ";
  const std::string pair = "rho: 0.53 delta: 0.2 ";
  const std::string orbit = "rho: 0.53 delta: 0.15 events: 1 ";
  return {
      {create,
       with("grid { " + Times(10'000, "rho: -1 ") + "}"),
       {"spec.grid.rho[1]", kAndMore},
       "left out"},
      {create,
       with("grid { " + Times(100, "table: 'x' ") + "table: 'rho' " + Times(100, "table: '' ") +
            "}"),
       {"spec.grid.table[0]", kAndMore},
       "(and 100 more)"},
      {create, hit + "priority: 101", {"priority"}, "-100 to 100"},
      {create,
       with("grid { rho: 0.4 } target { samples: 0 }") + "request_id: 'x'",
       {"request_id", "spec.grid.rho[1]", "spec.target.samples"}},
      {create, hit + "labels { key: 'A' value: 'x' }", {"labels"}, "has the key \"A\""},
      {create, hit + "labels { key: 'a' value: ' ' }", {"labels"}, "has the value \" \""},
      {"PlanEnsembleJob",
       with("grid { rho: 0.4 epsilon: 0.7 } target { tolerance: 0 }"),
       {"spec.grid.rho[1]", "spec.grid.epsilon[2]", "spec.target.tolerance"}},
      {"CancelEnsembleJob", "name: 'ensembleJobs/a' request_id: 'x'", {"request_id"}},
      {update, job + "job { priority: 101 } update_mask { paths: 'priority' }", {"job.priority"}},
      {update, job, {"update_mask"}, mask},
      {update, job + "update_mask { paths: '*' }", {"update_mask"}, mask},
      {update,
       job + "job { priority: -101 } update_mask { paths: ['pinned', 'state', 'priority'] }",
       {"update_mask", "job.priority"},
       mask},
      {list, "page_size: -1", {"page_size"}},
      {list, "page_token: '!!!'", {"page_token"}},
      {list, PageToken(v1::ListEnsembleJobsRequest(), -1), {"page_token"}},
      {list, PageToken(other_jobs, 1), {"page_token"}},
      {list, PageToken(other_results, 1), {"page_token"}},
      {list,
       "states: [RUNNING, STATE_UNSPECIFIED]",
       {"states[1]"},
       "is 0; permitted: QUEUED, RUNNING, CANCELLING, SUCCEEDED, FAILED, CANCELLED"},
      {list, Times(1'000'000, "states: 0 "), {"states[0]", kAndMore}, "(and 99 more)"},
      {list, "experiments: -1", {"experiments[0]"}, "is -1"},
      {list,
       "since { seconds: 253402300800 }",
       {"since.seconds"},
       "is 253402300800; permitted: -62135596800 to 253402300799"},
      {list, "since { nanos: -1 }", {"since.nanos"}},
      {results, of_job + "page_size: -5", {"page_size"}},
      {results, of_job + PageToken(other_results, 1), {"page_token"}},
      {results, of_job + "view: 9", {"view"}},
      {pairs, "", {"rho", "delta"}},
      {pairs, pair + "rho: 0.4 delta: [-1, nan]", {"rho[1]", "delta[1]", "delta[2]"}},
      {pairs,
       pair + "epsilon: 0.6 outgoing_epsilon: 0.5 beta: inf",
       {"epsilon[0]", "outgoing_epsilon[0]", "beta[0]"}},
      {pairs, pair + "outgoing_epsilon: 0.3", {"outgoing_epsilon"}, "epsilon has none"},
      {pairs,
       pair + "temperature: [0, -1, 1e-121, nan]",
       {"temperature[0]", "temperature[1]", "temperature[2]", "temperature[3]"},
       "temperature[0]: 0 is not in [1e-120, 1e+120]"},
      // Beyond the bound of the second rho, the smaller one.
      {pairs, "rho: [0.53, 0.6] delta: 0.3", {"delta[0]"}, "0.6: 0 < delta <= (1 - lambda)/2"},
      {pairs, Times(101, pair), {"rho"}},  // too many pairs
      {pairs, Times(100, "rho: 0.53 ") + "delta: 0.1 " + Times(201, "epsilon: 0.1 "), {"epsilon"}},
      {pairs,
       pair + Times(7, "epsilon: 0.1 ") + "outgoing_epsilon: 0.1 " +
           Times(12'494, "temperature: 1 "),
       {"temperature"},
       "100001 values"},
      {pairs, pair + "delta: 1e-300", {"delta[1]"}},  // beyond the range of double
      {pairs, "rho: 0.53 delta: 1e-130 temperature: 1e-120", {"delta[0]"}},  // the rate underflows
      {pairs,
       "rho: [0.6, 0.5000000000000002] delta: 3e-154",
       {"delta[0]"},
       "too small at rho = 0.5"},
      {pairs, "rho: 0.5000000000000002 delta: 1e-154", {"delta[0]"}},  // few digits remain
      {trace, "cells: '2x' temperature: 0", {"rho", "delta", "cells", "temperature", "events"}},
      {trace,
       "rho: 0.7071067811865475 delta: 1e-17 events: 1",
       {"rho", "delta"},
       "permitted with the models billiard and billiard_reference: 0.5 < rho <= "
       "0.7071067801865476"},
      {trace, orbit + "cells: '2' delta: 9e-11", {"delta"}, "delta >= 1e-10"},
      {trace, orbit + "events: 0", {"events"}, "is 0; permitted: 1 to 1000000"},
      {trace, orbit + "events: 1000001", {"events"}, "is 1000001"},
      {trace,
       orbit + "cells: '1001'",
       {"cells"},
       "1001 has 1001 cells; permitted in a trace: 1 to 1000"},
      {trace, orbit + "cells: '4' delta: 0.3", {"delta"}, "no two pistons may overlap"},
      {trace, orbit + "temperature: 1", {"temperature"}},  // a pair has no temperature
      {sample, hit, {"spec.grid"}, "has 6 points; permitted: one"},
      {sample, with("experiment: 0"), {"spec.experiment"}},
      {sample,
       "spec { experiment: ENERGY_RELAXATION grid { rho: 0.53 delta: 0.1 } model: MARKOV "
       "target { tolerance: 0.1 } }",
       {"spec.model", "spec.target"},
       "is markov; permitted: auto, billiard, billiard_reference"},
      {sample,
       "spec { experiment: LYAPUNOV grid { rho: 0.53 delta: 0.2 } }",
       {"spec.experiment"},
       "is lyapunov; permitted: an experiment with a pair, except lyapunov"},
      {sample,
       "spec { experiment: GAS_EQUILIBRIUM grid { rho: 0.53 delta: 0.1 cells: '4' } }",
       {"spec.experiment"},
       "is gas-equilibrium"}};
}

TEST(BadRequests, EveryBadFieldIsNamed) {
  using namespace google::protobuf;
  RunningServer server;
  for (BadRequest& bad : BadRequests()) {
    SCOPED_TRACE(bad.method + " " + bad.request.substr(0, 200));
    const Descriptor* type = DescriptorPool::generated_pool()->FindMessageTypeByName(
        "ballpiston.v1." + bad.method + "Request");
    const std::unique_ptr<Message> request(
        MessageFactory::generated_factory()->GetPrototype(type)->New());
    ASSERT_TRUE(TextFormat::MergeFromString(bad.request, request.get()));
    const grpc::Status status = server.Call(*request);
    EXPECT_THAT(status,
                StatusIs(grpc::StatusCode::INVALID_ARGUMENT, testing::HasSubstr(bad.message)));
    EXPECT_THAT(ReasonOf(status), testing::AnyOf("INVALID_SPEC", "INVALID_REQUEST"));
    const Fields named = FieldsOf(status);
    if (bad.fields.back() == kAndMore) {
      bad.fields.pop_back();
      EXPECT_THAT(named, testing::IsSupersetOf(bad.fields));
    } else {
      EXPECT_THAT(named, testing::UnorderedElementsAreArray(bad.fields));
    }
  }
  EXPECT_EQ(server.List().jobs_size(), 0);
}

TEST(BadRequests, AFieldOfANewerClientIsRefused) {
  RunningServer server;
  v1::CreateEnsembleJobRequest request = CreateRequest(Equilibrium(1, 1));
  request.GetReflection()->MutableUnknownFields(&request)->AddVarint(100, 1);
  const grpc::Status status = server.Call(request);
  EXPECT_EQ(ReasonOf(status), "INVALID_REQUEST");
  EXPECT_THAT(FieldsOf(status), testing::ElementsAre("request"));
}

// A few kilobytes could become a gigabyte.
TEST(BadRequests, CompressedOnesAreUnimplemented) {
  RunningServer server;
  for (const auto algorithm : {GRPC_COMPRESS_DEFLATE, GRPC_COMPRESS_GZIP}) {
    grpc::ChannelArguments arguments;
    arguments.SetCompressionAlgorithm(algorithm);
    const TestClient client(OwnChannel(server.address(), nullptr, arguments));
    EXPECT_THAT(client.Call(v1::EvaluatePairsRequest()), StatusIs(grpc::StatusCode::UNIMPLEMENTED));
  }
}

}  // namespace
}  // namespace ballpiston::server
