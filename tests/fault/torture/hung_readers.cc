#include "tests/fault/torture/hung_readers.h"

#include <grpcpp/grpcpp.h>
#include <signal.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <vector>

#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "tests/server/own_channel.h"

namespace ballpiston::torture {
namespace {

constexpr int kNoWatch = 3;

// The readers must get no message between these numbers of finished points.
struct Silence {
  int first = 0;
  int last = 0;
};

// A watch with a connection of its own.
struct Reader {
  std::unique_ptr<v1::EnsembleService::Stub> stub;
  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReader<v1::WatchEnsembleJobResponse>> stream;
};

std::unique_ptr<Reader> Open(const std::string& address, const std::string& job, bool reads) {
  auto reader = std::make_unique<Reader>();
  reader->stub =
      v1::EnsembleService::NewStub(server::OwnChannel(address, nullptr, server::SmallWindow()));
  v1::WatchEnsembleJobRequest request;
  request.set_name(job);
  reader->stream = reader->stub->WatchEnsembleJob(&reader->context, request);
  reader->stream->WaitForInitialMetadata();  // the first message is on its way
  v1::WatchEnsembleJobResponse first;
  if (reads && !reader->stream->Read(&first)) return nullptr;
  return reader;
}

int PointsDone(const v1::WatchEnsembleJobResponse& message) {
  return message.has_job() ? message.job().progress().points_done()
                           : message.snapshot().progress().points_done();
}

bool WasSilent(Reader& reader, const Silence& silence) {
  v1::WatchEnsembleJobResponse message;
  bool heard = false;
  while (reader.stream->Read(&message)) {
    const int done = PointsDone(message);
    if (done >= silence.last) return !heard;
    heard = heard || done > silence.first;
  }
  return false;
}

}  // namespace

int RunHungReaders(const std::string& count, const std::string& address, const std::string& job,
                   const std::string& silence_file) {
  std::vector<std::unique_ptr<Reader>> readers;
  for (int i = 0; i < std::atoi(count.c_str()); ++i) {
    readers.push_back(Open(address, job, i % 2 == 0));
    if (readers.back() == nullptr) std::_Exit(kNoWatch);
  }
  raise(SIGSTOP);
  Silence silence;
  std::ifstream(silence_file) >> silence.first >> silence.last;
  int silent = 0;
  for (const auto& reader : readers) silent += WasSilent(*reader, silence) ? 1 : 0;
  std::cout << silent << std::flush;
  std::_Exit(0);
}

HungReaders::HungReaders(int count, const std::string& address, const std::string& job)
    : process_({.command = {std::filesystem::read_symlink("/proc/self/exe"), kHungReaders,
                            std::to_string(count), address, job, folder_.File("silence")}}) {
  if (!process_.WaitUntilStopped()) {
    throw std::runtime_error("the readers could not watch " + job + ": " + process_.Wait().err);
  }
}

int HungReaders::WakeAndCountSilent(int first, int last) {
  std::ofstream(folder_.File("silence")) << first << " " << last;
  process_.Signal(SIGCONT);
  const ProcessResult result = process_.Wait();
  if (result.exit_code != 0) throw std::runtime_error("the readers did not wake: " + result.err);
  return std::stoi(result.out);
}

}  // namespace ballpiston::torture
