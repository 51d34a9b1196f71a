#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

class FigureTest : public ProgramTest {};

TEST_F(FigureTest, ListsItsNames) {
  EXPECT_THAT(Ballpiston({"figure", "--list"}).out, HasSubstr("mean-free-time: "));
}

// The package gets the flags as they were written, and the server in the environment.
TEST_F(FigureTest, StartsPythonAndReturnsItsExitCode) {
  const std::string python = home_.File("python");
  WriteFile(python,
            "#!/bin/sh\n[ \"$1\" = -c ] && exit 0  # the check of its modules\n"
            "echo \"$*\" $BALLPISTON_SERVER >" +
                home_.File("said") + "; exit 3\n");
  std::filesystem::permissions(python, std::filesystem::perms::owner_all);
  const ScopedVariable program("BALLPISTON_PYTHON", python);
  const ScopedVariable server("BALLPISTON_SERVER");  // the figure sets it
  const Outcome outcome =
      Ballpiston({"figure", "mean-free-time", "--out", "figures", "--quick", "--samples", "7",
                  "--relaxation-delta", "0.1,0.2", "--server", "h:1"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_EQ(Contents(home_.File("said")),
            "-m ballpiston.figures mean-free-time --out figures --quick --relaxation-delta 0.1,0.2 "
            "--samples 7 h:1\n");
}

}  // namespace
}  // namespace ballpiston::client
