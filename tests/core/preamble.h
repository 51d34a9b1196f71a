// What most tests of the core use: GoogleTest, the standard library, and the core's values that
// every layer speaks of. A test includes it after the header that it tests.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/pair_state.h"
#include "core/geometry/paper.h"
#include "core/sampling/counter_random.h"
#include "core/statistics/moments.h"
#include "tests/core/geometries.h"

namespace ballpiston {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::UnorderedElementsAre;

}  // namespace ballpiston
