// The tests, without the log of the stores whose disks they break: it would tell of every failure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/observability/log.h"

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  ballpiston::server::SetLogOptions({.silent = true});
  return RUN_ALL_TESTS();
}
