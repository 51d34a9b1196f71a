// What most torture tests use: a server process with its clients, questions, and findings.
#pragma once

#include "client/library/client.h"
#include "tests/fault/torture/connected_server.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/sizes.h"
#include "tests/support/preamble.h"
