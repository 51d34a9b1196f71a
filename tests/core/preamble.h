// The headers that most tests of the core need. A test includes this file after the header that it
// tests.
#pragma once

#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "core/sampling/counter_random.h"
#include "core/statistics/moments.h"
#include "tests/core/geometries.h"
#include "tests/support/preamble.h"
#include "tools/flows/paper.h"
