#include "client/output/result_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/message_text.h"

namespace ballpiston::client {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

v1::EnsembleJob FirstHitJob() {
  return FromText<v1::EnsembleJob>(R"(
    name: "ensembleJobs/abc" state: SUCCEEDED engine_version: "1"
    spec { experiment: FIRST_HIT seed: 7 target { samples: 10000 } }
    progress { points: 2 points_done: 2 samples: 20000 fraction: 1 })");
}

std::vector<v1::PointResult> TwoPoints() {
  return {FromText<v1::PointResult>(R"(
            index: 0 parameters { rho: 0.53 delta: 0.2 epsilon: 0 exponent: 1 }
            model: BILLIARD_REFERENCE samples: 10000
            estimates { name: "mean_hit_time" value: 21.63214 standard_error: 0.1234
                        exact: 21.62257 z_score: 0.0775527 }
            estimates { name: "mean_sigma" value: -0.25 }
            kl_divergence { value: 0.005 noise_floor: 0.0025 cells: 2000
                            noise_error: 0.0001 standard_error: 0.0002 }
            histograms { name: "alpha" sigma: 1 lower: 0 upper: 0.5 counts: [1, 0] }
            health { max_energy_error: 1e-12 })"),
          FromText<v1::PointResult>(R"(
            name: "ensembleJobs/abc/results/1"
            index: 1 parameters { rho: 0.53 delta: 0.1 epsilon: 0.25 exponent: 1 }
            model: BILLIARD_REFERENCE samples: 10000
            estimates { name: "mean_hit_time" value: 1e-7 standard_error: 2e-9 })")};
}

std::string Written(Format format, const std::vector<v1::PointResult>& points = TwoPoints(),
                    const v1::EnsembleJob& job = FirstHitJob()) {
  std::ostringstream out;
  const auto writer = NewResultWriter(format, out);
  writer->Begin(job);
  for (const v1::PointResult& point : points) writer->Add(point);
  writer->End();
  return out.str();
}

// Points by two models, with every field of an estimate.
std::vector<v1::PointResult> PointsOfTheLadder() {
  return {FromText<v1::PointResult>(R"(
            index: 0 parameters { rho: 0.53 delta: 0.1 } model: BILLIARD samples: 1e6
            estimates { name: "relaxation_time" value: 3.21098 standard_error: 0.0123
                        model_error: 0 limit: 3.14159 }
            reason: "the limit is off by 2.1e-02"
            curves { name: "energy_autocorrelation" points { time: 0 value: 1 } })"),
          FromText<v1::PointResult>(R"(
            index: 1 parameters { rho: 0.53 delta: 0.0125 } model: MARKOV samples: 1e6
            estimates { name: "relaxation_time" value: 3.14213 standard_error: 0.0123
                        model_error: 0.00234 limit: 3.14159 }
            estimates { name: "kernel_distance" value: 0.00213 standard_error: 0.00043
                        noise_floor: 0.00198 }
            reason: "the limit is off by 7.3e-04")")};
}

// A point of a gas between reservoirs.
v1::EnsembleJob JobOfAGas() {
  v1::EnsembleJob job = FirstHitJob();
  *job.mutable_spec()->mutable_grid() =
      FromText<v1::Grid>("rho: 0.53 delta: 0.1 cells: ['12', '4x3'] hot: 2 cold: 1");
  return job;
}

std::vector<v1::PointResult> PointsOfAGas() {
  return {FromText<v1::PointResult>(R"(
            index: 0 parameters { rho: 0.53 delta: 0.1 cells: "12" hot: 2 cold: 1 }
            model: BILLIARD samples: 100
            estimates { name: "heat_current" value: 0.25 standard_error: 0.012 }
            estimates { name: "conductivity" value: 0.5 standard_error: 0.023 }
            curves { name: "temperature" points { position: 0 value: 2 }
                     points { position: 0.5 value: 1.9 } }
            remarks: "the run was too short" remarks: "another sentence")"),
          FromText<v1::PointResult>(R"(
            index: 1 parameters { rho: 0.53 delta: 0.1 cells: "4x3" hot: 2 cold: 1 }
            model: BILLIARD samples: 100
            estimates { name: "heat_current" value: 0.75 standard_error: 0.034 })")};
}

TEST(ResultTable, AlignsAndRounds) {
  EXPECT_EQ(
      Written(Format::kTable),
      R"(first-hit, model billiard-reference, seed 7, engine 1  (ensembleJobs/abc, succeeded, 2 of 2 points)
 rho  delta  epsilon  exponent  samples  estimate           value    error  exact      z
0.53    0.2        0         1    10000  mean_hit_time      21.63     0.12  21.62  +0.08
0.53    0.2        0         1    10000  mean_sigma         -0.25
0.53    0.1     0.25         1    10000  mean_hit_time  1.000e-07  2.0e-09
)");
}

TEST(ResultTable, HasColumnsForTheLadder) {
  EXPECT_EQ(
      Written(Format::kTable, PointsOfTheLadder()),
      R"(first-hit, model billiard, markov, seed 7, engine 1  (ensembleJobs/abc, succeeded, 2 of 2 points)
 rho   delta  model     samples  estimate           value    error  exact  z  model_error  noise_floor  limit
0.53     0.1  billiard  1000000  relaxation_time    3.211    0.012                      0               3.142
0.53  0.0125  markov    1000000  relaxation_time    3.142    0.012                 0.0023               3.142
0.53  0.0125  markov    1000000  kernel_distance  0.00213  0.00043                             0.00198
billiard (rho 0.53, delta 0.1): the limit is off by 2.1e-02
markov (rho 0.53, delta 0.0125): the limit is off by 7.3e-04
)");
}

TEST(ResultTable, HasTheRemarksBelowTheEstimatesOfTheirPoint) {
  EXPECT_EQ(
      Written(Format::kTable, PointsOfAGas(), JobOfAGas()),
      R"(first-hit, model billiard, seed 7, engine 1  (ensembleJobs/abc, succeeded, 2 of 2 points)
 rho  delta  cells  hot  cold  samples  estimate      value  error  exact  z
0.53    0.1     12    2     1      100  heat_current  0.250  0.012
0.53    0.1     12    2     1      100  conductivity  0.500  0.023
remark: the run was too short
remark: another sentence
0.53    0.1    4x3    2     1      100  heat_current  0.750  0.034
)");
}

TEST(ResultTable, HasAHeadingWithoutPoints) {
  std::ostringstream out;
  const auto writer = NewResultWriter(Format::kTable, out);
  v1::EnsembleJob job = FirstHitJob();
  job.set_state(v1::EnsembleJob::RUNNING);
  job.mutable_progress()->set_points_done(0);
  writer->Begin(job);
  writer->End();
  EXPECT_EQ(out.str(),
            "first-hit, no finished points, seed 7, engine 1  "
            "(ensembleJobs/abc, running, 0 of 2 points)\n");
}

TEST(ResultCsv, HasARowForEachPointAndEstimate) {
  EXPECT_EQ(
      Written(Format::kCsv),
      R"(rho,delta,epsilon,exponent,model,samples,name,value,standard_error,exact,z_score,model_error,noise_floor,limit
0.53,0.2,0,1,billiard-reference,10000,mean_hit_time,21.63214,0.1234,21.62257,0.0775527,,,
0.53,0.2,0,1,billiard-reference,10000,mean_sigma,-0.25,,,,,,
0.53,0.1,0.25,1,billiard-reference,10000,mean_hit_time,1e-07,2e-09,,,,,
)");
}

TEST(ResultCsv, HasTheLadderInItsLastColumns) {
  EXPECT_EQ(
      Written(Format::kCsv, PointsOfTheLadder()),
      R"(rho,delta,epsilon,exponent,model,samples,name,value,standard_error,exact,z_score,model_error,noise_floor,limit
0.53,0.1,,,billiard,1000000,relaxation_time,3.21098,0.0123,,,0,,3.14159
0.53,0.0125,,,markov,1000000,relaxation_time,3.14213,0.0123,,,0.00234,,3.14159
0.53,0.0125,,,markov,1000000,kernel_distance,0.00213,0.00043,,,,0.00198,
)");
}

TEST(ResultCsv, HasColumnsForTheParametersOfAGasAndNoRemarks) {
  EXPECT_EQ(
      Written(Format::kCsv, PointsOfAGas(), JobOfAGas()),
      R"(rho,delta,epsilon,exponent,cells,hot,cold,model,samples,name,value,standard_error,exact,z_score,model_error,noise_floor,limit
0.53,0.1,,,12,2,1,billiard,100,heat_current,0.25,0.012,,,,,
0.53,0.1,,,12,2,1,billiard,100,conductivity,0.5,0.023,,,,,
0.53,0.1,,,4x3,2,1,billiard,100,heat_current,0.75,0.034,,,,,
)");
}

TEST(ResultCsv, HistogramsHaveARowForEachBinWithDensities) {
  std::vector<v1::PointResult> points = {TwoPoints()[0]};
  *points[0].mutable_histograms(0) = FromText<v1::Histogram>(R"(
    name: "alpha" sigma: 1 lower: 0 upper: 0.5 counts: [1, 2]
    expected_probabilities: [0.25, 0.25])");
  *points[0].add_histograms() = FromText<v1::Histogram>(R"(
    name: "alpha" sigma: -1 lower: 0 upper: 0.25 counts: [1] expected_probabilities: [0.5])");
  *points[0].add_histograms() = FromText<v1::Histogram>(R"(
    name: "piston_energy" lower: 0 upper: 0.5 expected_probabilities: [1] time: 2)");
  EXPECT_EQ(
      Written(Format::kCsvHistograms, points),
      R"(rho,delta,epsilon,exponent,model,samples,name,sigma,time,lower,upper,count,density,exact_density
0.53,0.2,0,1,billiard-reference,10000,alpha,1,,0,0.25,1,1,1
0.53,0.2,0,1,billiard-reference,10000,alpha,1,,0.25,0.5,2,2,1
0.53,0.2,0,1,billiard-reference,10000,alpha,-1,,0,0.25,1,1,2
0.53,0.2,0,1,billiard-reference,10000,piston_energy,0,2,0,0.5,,,2
)");
}

TEST(ResultCsv, CurvesHaveARowForEachPoint) {
  std::vector<v1::PointResult> points = {PointsOfTheLadder()[0]};
  *points[0].mutable_curves(0) = FromText<v1::Curve>(R"(
    name: "energy_autocorrelation" points { time: 0 value: 1 limit: 1 }
    points { position: 0.5 value: 0.5 standard_error: 0.125 })");
  EXPECT_EQ(
      Written(Format::kCsvCurves, points),
      R"(rho,delta,epsilon,exponent,model,samples,name,time,position,value,standard_error,limit
0.53,0.1,,,billiard,1000000,energy_autocorrelation,0,,1,,1
0.53,0.1,,,billiard,1000000,energy_autocorrelation,,0.5,0.5,0.125,
)");
}

TEST(ResultJson, HasShapesPositionsAndRemarks) {
  const std::string text = Written(Format::kJsonl, PointsOfAGas(), JobOfAGas());
  EXPECT_THAT(text, HasSubstr(R"("cells":"12","hot":2,"cold":1})"));
  EXPECT_THAT(text,
              HasSubstr(R"("points":[{"value":2,"position":0},{"value":1.9,"position":0.5}])"));
  EXPECT_THAT(text, HasSubstr(R"("remarks":["the run was too short","another sentence"],)"));
}

TEST(ResultJson, HasReasonsAndCurves) {
  const std::string text = Written(Format::kJsonl, PointsOfTheLadder());
  EXPECT_THAT(text, HasSubstr(R"("reason":"the limit is off by 2.1e-02","samples":1000000,)"));
  EXPECT_THAT(text, HasSubstr(R"("curves":[{"name":"energy_autocorrelation","points":[)"
                              R"({"value":1,"time":0}]}])"));
  EXPECT_THAT(text, HasSubstr(R"("model_error":0,"limit":3.14159)"));
}

TEST(ResultJson, HasTheProtosNamesAndKeepsDefaults) {
  EXPECT_EQ(Written(Format::kJson), R"({"client_version": ")" BALLPISTON_VERSION R"(",
"job": {"name":"ensembleJobs/abc","spec":{"experiment":"FIRST_HIT","target":{"estimate":"","samples":"10000"},"seed":"7","model":"MODEL_UNSPECIFIED","precision":"PRECISION_UNSPECIFIED","verify":false},"state":"SUCCEEDED","progress":{"points":2,"points_done":2,"samples":20000,"fraction":1},"engine_version":"1","work":0,"principal":"","priority":0,"answered_from_store":false,"pinned":false,"results_expired":false,"stored_bytes":0,"labels":{},"continues":"","continued_samples":0},
"points": [
{"index":0,"parameters":{"rho":0.53,"delta":0.2,"epsilon":0,"exponent":1},"model":"BILLIARD_REFERENCE","reason":"","samples":10000,"estimates":[{"name":"mean_hit_time","value":21.63214,"standard_error":0.1234,"exact":21.62257,"z_score":0.0775527},{"name":"mean_sigma","value":-0.25}],"kl_divergence":{"value":0.005,"noise_floor":0.0025,"cells":2000,"noise_error":0.0001,"standard_error":0.0002},"health":{"escapes":0,"max_energy_error":1e-12},"remarks":[],"histograms":[{"name":"alpha","sigma":1,"lower":0,"upper":0.5,"counts":[1,0],"expected_probabilities":[]}],"curves":[],"chunk_digests":[]},
{"index":1,"parameters":{"rho":0.53,"delta":0.1,"epsilon":0.25,"exponent":1},"model":"BILLIARD_REFERENCE","reason":"","samples":10000,"estimates":[{"name":"mean_hit_time","value":1e-07,"standard_error":2e-09}],"remarks":[],"histograms":[],"curves":[],"chunk_digests":[]}
]}
)");
}

TEST(ResultJson, IsADocumentWithoutPoints) {
  std::ostringstream out;
  const auto writer = NewResultWriter(Format::kJson, out);
  writer->Begin(v1::EnsembleJob());
  writer->End();
  EXPECT_EQ(out.str(),
            "{\"client_version\": \"" BALLPISTON_VERSION
            "\",\n\"job\": "
            "{\"name\":\"\",\"state\":\"STATE_UNSPECIFIED\",\"engine_version\":\"\",\"work\":0,"
            "\"principal\":\"\",\"priority\":0,\"answered_from_store\":false,\"pinned\":false,"
            "\"results_expired\":false,\"stored_bytes\":0,\"labels\":{},\"continues\":\"\","
            "\"continued_samples\":0},\n"
            "\"points\": [\n]}\n");
}

TEST(ResultJsonl, HasALineForEachPoint) {
  const std::string text = Written(Format::kJsonl);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_THAT(text, StartsWith("{\"index\":0,"));
  EXPECT_THAT(text, HasSubstr("\n{\"index\":1,"));
}

TEST(ResultWriter, OnlyJsonAndCsvOfHistogramsOrCurvesRequestTheFullView) {
  EXPECT_EQ(ViewFor(Format::kCsvHistograms), v1::ListResultsRequest::FULL);
  EXPECT_EQ(ViewFor(Format::kCsvCurves), v1::ListResultsRequest::FULL);
  EXPECT_EQ(ViewFor(Format::kJson), v1::ListResultsRequest::FULL);
  EXPECT_EQ(ViewFor(Format::kJsonl), v1::ListResultsRequest::FULL);
  EXPECT_EQ(ViewFor(Format::kTable), v1::ListResultsRequest::BASIC);
  EXPECT_EQ(ViewFor(Format::kCsv), v1::ListResultsRequest::BASIC);
}

}  // namespace
}  // namespace ballpiston::client
