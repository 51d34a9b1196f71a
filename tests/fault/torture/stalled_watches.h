// Watches whose readers stall. Each has a connection of its own, with a window that 64 KiB of
// unread messages fill; then the server can send no more.
#pragma once

#include <list>

#include "tests/server/calls.h"
#include "tests/support/preamble.h"

namespace ballpiston::torture {

class StalledWatches {
 public:
  // Opens the watches; from then on they read nothing. Half of the watches do not even read their
  // first message, which is as large as the job.
  StalledWatches(int count, const std::string& address, const std::string& job) {
    for (int i = 0; i < count; ++i) {
      server::WatchStream& watch = readers_.emplace_back(address, job).watch;
      watch.AwaitAnswer();  // the first message is on its way
      if (i % 2 == 0 && !watch.Next()) throw std::runtime_error("cannot watch " + job);
    }
  }

  // Reads again; call it once. Each watch reads until a message has at least `last` finished
  // points. Returns the number of watches that got no message with more than `first` and fewer than
  // `last` finished points. For these the server had one message waiting and made no other one.
  int CountSilent(int first, int last) {
    int silent = 0;
    for (Reader& reader : readers_) silent += WasSilent(reader.watch, first, last) ? 1 : 0;
    return silent;
  }

 private:
  struct Reader {
    Reader(const std::string& address, const std::string& job)
        : client(server::OwnChannel(address, nullptr, server::SmallWindow())), watch(client, job) {}
    server::TestClient client;
    server::WatchStream watch;
  };

  static int PointsDone(const server::WatchMessage& message) {
    return message.has_job() ? message.job().progress().points_done()
                             : message.snapshot().progress().points_done();
  }

  static bool WasSilent(server::WatchStream& watch, int first, int last) {
    bool heard = false;
    while (const auto message = watch.Next()) {
      const int done = PointsDone(*message);
      if (done >= last) return !heard;
      heard = heard || done > first;
    }
    return false;
  }

  std::list<Reader> readers_;
};

}  // namespace ballpiston::torture
