#include "tests/fault/torture/hung_readers.h"

#include <grpcpp/grpcpp.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <vector>

#include "ballpiston/v1/ensemble.grpc.pb.h"

namespace ballpiston::torture {
namespace {

constexpr int kNoWatch = 3;

// A watch with a connection of its own.
struct Reader {
  std::unique_ptr<v1::EnsembleService::Stub> stub;
  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReader<v1::WatchEnsembleJobResponse>> stream;
};

std::unique_ptr<Reader> Open(const std::string& address, const std::string& job) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  auto reader = std::make_unique<Reader>();
  reader->stub = v1::EnsembleService::NewStub(
      grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments));
  v1::WatchEnsembleJobRequest request;
  request.set_name(job);
  reader->stream = reader->stub->WatchEnsembleJob(&reader->context, request);
  v1::WatchEnsembleJobResponse first;
  return reader->stream->Read(&first) ? std::move(reader) : nullptr;
}

}  // namespace

int RunHungReaders(const std::string& count, const std::string& address, const std::string& job) {
  std::vector<std::unique_ptr<Reader>> readers;
  for (int i = 0; i < std::atoi(count.c_str()); ++i) {
    readers.push_back(Open(address, job));
    if (readers.back() == nullptr) std::_Exit(kNoWatch);
  }
  kill(getpid(), SIGSTOP);
  std::_Exit(0);
}

HungReaders::HungReaders(int count, const std::string& address, const std::string& job) {
  std::vector<std::string> words = {"/proc/self/exe", kHungReaders, std::to_string(count), address,
                                    job};
  std::vector<char*> command;
  for (std::string& word : words) command.push_back(word.data());
  command.push_back(nullptr);
  if (posix_spawn(&pid_, "/proc/self/exe", nullptr, nullptr, command.data(), environ) != 0) {
    throw std::runtime_error("cannot start the readers");
  }
  int status = 0;
  waitpid(pid_, &status, WUNTRACED);
  if (!WIFSTOPPED(status)) throw std::runtime_error("the readers could not watch " + job);
}

HungReaders::~HungReaders() {
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

}  // namespace ballpiston::torture
