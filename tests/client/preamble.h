// The headers that most tests of the client need: the client's library, and the program with a fake
// server. A test includes this file after the header that it tests.
#pragma once

#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "client/library/client.h"
#include "client/library/error_text.h"
#include "tests/client/fake_server.h"
#include "tests/client/program.h"
#include "tests/support/message_text.h"
#include "tests/support/preamble.h"
#include "tests/support/scoped.h"

namespace ballpiston::client {

using testing::AnyOf;
using testing::Ge;
using testing::Le;
using testing::MatchesRegex;

}  // namespace ballpiston::client
