// A Slurm cluster of two nodes on this machine; and a real server with this cluster, and one job
// that is large enough for it.
#pragma once

#include <cstdio>
#include <exception>

#include "tests/end_to_end/programs.h"

namespace ballpiston {

// Runs scripts/test-cluster.sh, which says what its verbs do. A verb that fails throws
// std::runtime_error.
class Cluster {
 public:
  // `parameters`: lines of slurm.conf, as NAME=VALUE.
  explicit Cluster(const Words& parameters) {
    const std::string stop =
        absl::StrCat("cat >/dev/null; exec '", script_, "' stop '", path_, "'");
    keeper_.reset(popen(stop.c_str(), "we"));
    if (keeper_ == nullptr) throw std::runtime_error("no shell");
    Do("start", parameters);
  }

  // Runs a verb, such as Do("kill-node", {"n1"}).
  void Do(const std::string& verb, const Words& more = {}) const {
    const ProcessResult result = RunProgram({.command = Joined({{script_, verb, path_}, more})});
    if (result.exit_code != 0) throw std::runtime_error(verb + " failed: " + result.err);
  }

  // sbatch, squeue and so on.
  ProcessResult Tool(Words words) const {
    return RunProgram({.command = std::move(words), .environment = {{"SLURM_CONF", conf()}}});
  }
  // Lines of squeue: tasks of all users and jobs that wait or run.
  Words Queue() const {
    return absl::StrSplit(Tool({"squeue", "--noheader", "-r", "--format=%F|%K|%j|%T|%r"}).out, '\n',
                          absl::SkipEmpty());
  }

  std::string conf() const { return path_ + "/slurm.conf"; }
  const TemporaryFolder& folder() const { return folder_; }

 private:
  struct Stop {
    void operator()(std::FILE* pipe) const { pclose(pipe); }
  };

  const std::string script_ = SourcePath("scripts/test-cluster.sh");
  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("cluster");
  // A shell that waits for the end of this pipe. The shell stops the cluster when this object is
  // destroyed or this process ends for any reason.
  std::unique_ptr<std::FILE, Stop> keeper_;
};

struct SweepSetUp {
  Words cluster = {};  // lines of slurm.conf
  Words flags = {};    // of the server
  int lease_seconds = 3;
  int timeout_seconds = 10;  // of a lease
  int samples = 1'000'000;   // of each of the 16 points: 20 s of one core
  int workers = 1;
};

// The cluster and the server run.
class Sweep {
 public:
  explicit Sweep(SweepSetUp set_up) : set_up_(std::move(set_up)), cluster_(set_up_.cluster) {
    mkdir(shared_folder().c_str(), 0700);
    server_.emplace(ServerSetUp{.workers = set_up_.workers,
                                .flags = Flags(),
                                .launcher = {"env", "SLURM_CONF=" + cluster_.conf()}});
  }
  ~Sweep() {
    if (testing::Test::HasFailure() || std::uncaught_exceptions() > 0) {
      std::cerr << server_->log() << std::endl;
    }
  }

  const Cluster& cluster() const { return cluster_; }
  TestServer& server() { return *server_; }
  std::string shared_folder() const { return cluster_.folder().File("shared"); }
  const std::string& job() const { return job_; }

  void Submit() { job_ = server_->Submit(Question(set_up_.samples)); }
  void SubmitAndAwaitTasks() {
    Submit();
    AwaitRunningTasks();
  }
  void AwaitRunningTasks() const {
    AwaitThat([this] { return !Workers().empty(); });
  }
  // The state of the cluster in the answer of `ballpiston status`.
  v1::ClusterStatus Status() const { return server_->Status().cluster(); }
  std::string Problem() const { return Status().problem(); }
  void AwaitProblem(const std::string& text) const {
    AwaitThat([&] { return absl::StrContains(Problem(), text); });
  }
  void AwaitNoLeases() const {
    AwaitThat([this] {
      const v1::ClusterStatus status = Status();
      return status.waiting_leases() + status.taken_leases() == 0;
    });
  }
  std::vector<pid_t> Workers() const {  // that compute
    const std::string end(1, '\0');
    return ProcessesWith(absl::StrCat("ballpiston-worker", end, shared_folder(), end));
  }

  // Waits for the end. The test fails unless the job succeeded, each point has the number of
  // samples that was asked for, and the bytes are those of a server that has threads alone.
  void ExpectTheSameBytes() {
    const std::string points = PointsAtTheEnd(*server_, job_);
    const auto result = FromJson<file::v1::SavedResult>("{" + points);
    EXPECT_EQ(result.points_size(), kPoints);
    for (const v1::PointResult& point : result.points()) {
      EXPECT_EQ(point.samples(), set_up_.samples);
    }
    EXPECT_TRUE(points == PlainPoints(set_up_.samples)) << "other bytes than with threads alone";
  }

 private:
  static constexpr int kPoints = 16;
  static Words Question(int samples) {
    return Joined({Split("first-hit --rho 0.529561127988977 --delta 0.1,0.08,0.06,0.05 --epsilon "
                         "0.1,0.2,0.3,0.4 --exponent 1 --model billiard --seed 11 --samples"),
                   {absl::StrCat(samples)}});
  }

  // A job of a few seconds is large enough, a lease takes some seconds, and Slurm is asked often.
  Words Flags() const {
    return Joined({Split("--executor=slurm --cluster-least-seconds 2 --slurm-query-seconds 2"),
                   {"--cluster-folder", shared_folder()},
                   {"--cluster-timeout-seconds", absl::StrCat(set_up_.timeout_seconds)},
                   {"--cluster-lease-seconds", absl::StrCat(set_up_.lease_seconds)},
                   set_up_.flags});
  }

  static std::string PointsAtTheEnd(const TestServer& server, const std::string& job) {
    EXPECT_THAT(server.Client({"watch", job}), ExitsWith(0));
    const ProcessResult result = server.Client({"result", job, "--format", "json"});
    EXPECT_THAT(result, ExitsWith(0));
    return PointsOf(result.out);
  }

  // By threads alone. Computed once for each number of samples.
  static const std::string& PlainPoints(int samples) {
    static std::map<int, std::string> known;
    std::string& points = known[samples];
    if (!points.empty()) return points;
    const TestServer server;
    return points = PointsAtTheEnd(server, server.Submit(Question(samples)));
  }

  const SweepSetUp set_up_;
  const Cluster cluster_;
  std::optional<TestServer> server_;
  std::string job_;
};

}  // namespace ballpiston
