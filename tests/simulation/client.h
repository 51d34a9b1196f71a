// A client that calls the server at random and compares each answer with the expectations.
#pragma once

#include "tests/simulation/expectations.h"
#include "tests/simulation/life.h"
#include "tests/simulation/machine.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

// The kinds of calls that can be switched off. A client always creates, reads, lists and pins jobs.
struct ClientHabits {
  bool cancels = true;
  bool deletes = true;
  bool watches = true;
  bool retries = true;  // with a key
};

// All clients use these objects together.
struct ClientWorld {
  Machine& machine;
  Expectations& expectations;
  ClientHabits habits;
  std::function<std::shared_ptr<Life>()> life;  // null: no server
  // The number of times so far that calls could begin to fail: the disk fails, or the server stops.
  std::function<uint64_t()> troubles;
  std::function<bool()> is_in_trouble;
  std::function<void(const std::string&)> tell;  // records an event, which a failure prints
};

class Client {
 public:
  explicit Client(ClientWorld& world) : world_(world) {}

  // One call, of any kind. Throws Violation.
  void CallOnce();

  void Create();
  void Get(const std::string& id);
  void List();
  void Cancel(const std::string& id);
  void Delete(const std::string& id);
  void Update(const std::string& id);
  void Read(const std::string& id);
  void Watch(const std::string& id);

 private:
  class Call;
  class Reader;
  // A watch and the watches that resume it.
  struct Chain {
    std::string token;
    std::vector<v1::PointResult> points;
    bool has_ended = false;
  };

  ClientWorld& world_;
  std::map<std::string, Chain> chains_;  // by job
};

}  // namespace ballpiston::server
