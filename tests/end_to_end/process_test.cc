// Class Process, which starts the programs of these tests.
#include "tests/support/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <memory>
#include <thread>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

TEST(Process, DiesWithTheThreadThatStartedIt) {
  std::unique_ptr<Process> process;
  std::thread([&] {
    process = std::make_unique<Process>(
        ProcessOptions{.command = {"sh", "-c", "echo started >&2; exec sleep 1000"}});
    process->WaitForErr("started");
  }).join();
  EXPECT_THAT(process->Wait(), ExitsWith(128 + SIGKILL));
}

}  // namespace
}  // namespace ballpiston
