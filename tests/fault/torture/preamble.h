// The headers that most torture tests need: a server process, its clients, questions to it, and the
// findings that a test counts.
#pragma once

#include "client/library/client.h"
#include "tests/fault/torture/connected_server.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/sizes.h"
#include "tests/support/preamble.h"
