#include "tests/slurm/sweep.h"

namespace ballpiston {
namespace {

std::string Script() { return SourcePath("scripts/test-cluster.sh"); }

void Run(std::vector<std::string> words) {
  const ProcessResult result = RunProgram({.command = words});
  if (result.exit_code == 0) return;
  throw std::runtime_error(absl::StrCat(words[1], " failed: ", result.err));
}

// A job of a few seconds is large enough, a lease takes some seconds, and Slurm is asked often.
Words FlagsOf(const std::string& shared_folder, const SweepSetUp& set_up) {
  return Joined({{"--executor=slurm", "--cluster-folder", shared_folder, "--cluster-least-seconds",
                  "2", "--slurm-query-seconds", "2", "--cluster-timeout-seconds",
                  absl::StrCat(set_up.timeout_seconds), "--cluster-lease-seconds",
                  absl::StrCat(set_up.lease_seconds)},
                 set_up.flags});
}

std::string PointsOfJob(const TestServer& server, const std::string& job) {
  const ProcessResult result = server.Client({"result", job, "--format", "json"});
  EXPECT_THAT(result, ExitsWith(0));
  return PointsOf(result.out);
}

// By threads alone. Computed once for each number of samples.
const std::string& PlainPoints(int samples) {
  static std::map<int, std::string>& known = *new std::map<int, std::string>;
  std::string& points = known[samples];
  if (!points.empty()) return points;
  const TestServer server;
  const std::string job = server.Submit(SweepOf(samples));
  EXPECT_THAT(server.Client({"watch", job}), ExitsWith(0));
  return points = PointsOfJob(server, job);
}

void ExpectSamples(const std::string& points, int samples) {
  const auto result = FromJson<file::v1::SavedResult>("{" + points);
  ASSERT_EQ(result.points_size(), kPoints);
  for (const v1::PointResult& point : result.points()) EXPECT_EQ(point.samples(), samples);
}

}  // namespace

Cluster::Cluster(const std::vector<std::string>& parameters) {
  const std::string folder = folder_.File("cluster");
  const std::string stop =
      absl::StrCat("cat >/dev/null; exec '", Script(), "' stop '", folder, "'");
  keeper_.reset(popen(stop.c_str(), "we"));
  if (keeper_ == nullptr) throw std::runtime_error("no shell");
  std::vector<std::string> words = {Script(), "start", folder};
  words.insert(words.end(), parameters.begin(), parameters.end());
  Run(words);
}

void Cluster::Do(const std::string& verb, const std::string& node) const {
  std::vector<std::string> words = {Script(), verb, folder_.File("cluster")};
  if (!node.empty()) words.push_back(node);
  Run(words);
}

ProcessResult Cluster::Tool(std::vector<std::string> words) const {
  return RunProgram({.command = std::move(words), .environment = {{"SLURM_CONF", conf()}}});
}

std::vector<std::string> Cluster::Queue() const {
  return absl::StrSplit(Tool({"squeue", "--noheader", "-r", "--format=%F|%K|%j|%T|%r"}).out, '\n',
                        absl::SkipEmpty());
}

Words SweepOf(int samples, int seed) {
  return Joined({Split("first-hit --rho 0.529561127988977 --delta 0.1,0.08,0.06,0.05 "
                       "--epsilon 0.1,0.2,0.3,0.4 --exponent 1 --model billiard"),
                 {"--seed", absl::StrCat(seed), "--samples", absl::StrCat(samples)}});
}

Sweep::Sweep(SweepSetUp set_up) : set_up_(std::move(set_up)), cluster_(set_up_.cluster) {
  mkdir(shared_folder().c_str(), 0700);
  server_ = std::make_unique<TestServer>(
      ServerSetUp{.workers = set_up_.workers,
                  .flags = FlagsOf(shared_folder(), set_up_),
                  .launcher = {"env", "SLURM_CONF=" + cluster_.conf()}});
}

Sweep::~Sweep() {
  if (testing::Test::HasFailure()) std::cerr << server_->log() << std::endl;
}

void Sweep::Submit() { job_ = server_->Submit(SweepOf(set_up_.samples)); }

ClusterCounts Sweep::Counts() const {
  const v1::ClusterStatus cluster = server_->Status().cluster();
  return {.problem = cluster.problem(),
          .leases = cluster.waiting_leases() + cluster.taken_leases(),
          .chunks = cluster.chunks(),
          .lost = cluster.lost_leases(),
          .refused = cluster.refused_files()};
}

void Sweep::AwaitTasks() const {
  AwaitThat([this] { return !cluster_.Queue().empty(); });
}

void Sweep::AwaitRunningTasks() const {
  AwaitThat([this] { return !Workers().empty(); });
}

void Sweep::AwaitTakenLease() const {
  AwaitThat([this] { return !NamesIn(shared_folder() + "/taken").empty(); });
}

void Sweep::AwaitProblem(const std::string& text) const {
  AwaitThat([&] { return Counts().problem.find(text) != std::string::npos; });
}

std::vector<pid_t> Sweep::Workers() const {
  return ProcessesWith(absl::StrCat("ballpiston-worker", std::string(1, '\0'), shared_folder(),
                                    std::string(1, '\0')));
}

void Sweep::KillServer() {
  server_->KillHard();
  server_->Start();
}

void Sweep::ExpectTheSameBytes() {
  EXPECT_THAT(server_->Client({"watch", job_}), ExitsWith(0));
  const std::string points = PointsOfJob(*server_, job_);
  ExpectSamples(points, set_up_.samples);
  EXPECT_TRUE(points == PlainPoints(set_up_.samples)) << "other bytes than with threads alone";
}

}  // namespace ballpiston
