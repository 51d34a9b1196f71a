#include "tests/fault/torture/hung_readers.h"

#include <grpcpp/grpcpp.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <vector>

#include "ballpiston/v1/ensemble.grpc.pb.h"

namespace ballpiston::torture {
namespace {

constexpr int kNoWatch = 3;

// Between which numbers of finished points the readers were to be silent.
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
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);  // the server may send 64 KiB ahead, and no more
  auto reader = std::make_unique<Reader>();
  reader->stub = v1::EnsembleService::NewStub(
      grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments));
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

int RunHungReaders(const std::string& count, const std::string& address, const std::string& job) {
  std::vector<std::unique_ptr<Reader>> readers;
  for (int i = 0; i < std::atoi(count.c_str()); ++i) {
    readers.push_back(Open(address, job, i % 2 == 0));
    if (readers.back() == nullptr) std::_Exit(kNoWatch);
  }
  raise(SIGSTOP);
  Silence silence;
  if (read(STDIN_FILENO, &silence, sizeof(silence)) != sizeof(silence)) std::_Exit(0);
  int silent = 0;
  for (const auto& reader : readers) silent += WasSilent(*reader, silence) ? 1 : 0;
  std::_Exit(write(STDOUT_FILENO, &silent, sizeof(silent)) == sizeof(silent) ? 0 : 1);
}

HungReaders::HungReaders(int count, const std::string& address, const std::string& job) {
  int sockets[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0) {
    throw std::runtime_error("no pair of sockets");
  }
  socket_ = sockets[0];
  std::vector<std::string> words = {"/proc/self/exe", kHungReaders, std::to_string(count), address,
                                    job};
  std::vector<char*> command;
  for (std::string& word : words) command.push_back(word.data());
  command.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, sockets[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, sockets[1], STDOUT_FILENO);
  const int error =
      posix_spawn(&pid_, "/proc/self/exe", &actions, nullptr, command.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(sockets[1]);
  if (error != 0) throw std::runtime_error("cannot start the readers");
  int status = 0;
  waitpid(pid_, &status, WUNTRACED);
  if (!WIFSTOPPED(status)) throw std::runtime_error("the readers could not watch " + job);
}

HungReaders::~HungReaders() {
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  close(socket_);
}

int HungReaders::WakeAndCountSilent(int first, int last) {
  const Silence silence{first, last};
  kill(pid_, SIGCONT);
  int silent = 0;
  if (write(socket_, &silence, sizeof(silence)) != sizeof(silence) ||
      read(socket_, &silent, sizeof(silent)) != sizeof(silent)) {
    throw std::runtime_error("the readers did not wake");
  }
  return silent;
}

}  // namespace ballpiston::torture
