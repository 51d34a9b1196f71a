// Submits a sweep to a server, waits for the job, and prints one line for each point.
//
//   ./sweep                    the private server, which is started when it is needed
//   ./sweep lab.example:50051  or unix:PATH
#include <ballpiston/client/channel.h>
#include <ballpiston/client/client.h>
#include <ballpiston/client/local_server.h>

#include <iostream>

namespace {

using namespace ballpiston;

absl::StatusOr<std::shared_ptr<grpc::Channel>> Connect(int argc, char** argv) {
  if (argc > 1) return client::OpenChannel(argv[1]);
  const absl::StatusOr<client::LocalServer> server = client::FindLocalServer();
  if (!server.ok()) return server.status();
  return client::ConnectToLocalServer(*server);
}

// The mean time until ball and piston meet, at two penetrations.
v1::EnsembleSpec Question() {
  v1::EnsembleSpec spec;
  spec.set_experiment(v1::EnsembleSpec::FIRST_HIT);
  spec.mutable_grid()->add_rho(0.5296);
  spec.mutable_grid()->add_delta(0.2);
  spec.mutable_grid()->add_delta(0.1);
  spec.mutable_grid()->add_epsilon(0.125);
  spec.mutable_grid()->add_exponent(1);
  spec.mutable_target()->set_samples(20'000);
  spec.set_seed(7);
  return spec;
}

void ShowProgress(const v1::StatisticsSnapshot& snapshot) {
  std::cerr << snapshot.progress().points_done() << " of " << snapshot.progress().points()
            << " points are finished\n";
}

absl::Status Run(const client::Client& server) {
  absl::StatusOr<v1::EnsembleJob> job = server.Create(Question());
  if (!job.ok()) return job.status();
  job = server.Watch(job->name(), {.on_snapshot = &ShowProgress});
  if (!job.ok()) return job.status();
  const auto points = server.Results(job->name());
  if (!points.ok()) return points.status();
  for (const v1::PointResult& point : *points) {
    const v1::Estimate& first = point.estimates(0);
    std::cout << "delta " << point.parameters().delta() << ": " << first.name() << " "
              << first.value() << " +- " << first.standard_error() << ", exactly " << first.exact()
              << "\n";
  }
  return absl::OkStatus();
}

}  // namespace

int main(int argc, char** argv) {
  const auto channel = Connect(argc, argv);
  const absl::Status status = channel.ok() ? Run(client::Client(*channel)) : channel.status();
  if (status.ok()) return 0;
  std::cerr << status.message() << '\n';  // every violation, with its field
  return 1;
}
