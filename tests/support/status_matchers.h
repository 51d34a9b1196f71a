// Matchers and assertions for absl::Status, absl::StatusOr and grpc::Status.
//
//   EXPECT_OK(store.Delete(id));
//   ASSERT_OK_AND_ASSIGN(const PairGeometry pair, PairGeometry::Create(rho, delta));
//   EXPECT_THAT(PairGeometry::Create(rho, -1),
//               StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("delta")));
//   EXPECT_THAT(ParseNumber("1e3"), IsOkAndHolds(1000));
#pragma once

#include <string>
#include <utility>

#include "absl/status/status.h"
#include "gmock/gmock.h"

namespace ballpiston {

// The status of a Status, a StatusOr or a grpc::Status; their codes have the same numbers. This
// function recognises a grpc::Status by its member functions, because tests of the core do not
// include gRPC.
template <typename Result>
absl::Status StatusOf(const Result& result) {
  if constexpr (requires { result.error_code(); }) {
    return absl::Status(static_cast<absl::StatusCode>(result.error_code()), result.error_message());
  } else if constexpr (requires { result.status(); }) {
    return result.status();
  } else {
    return result;
  }
}

MATCHER(IsOk, "") {
  const absl::Status status = StatusOf(arg);
  *result_listener << "whose status is " << status;
  return status.ok();
}

MATCHER_P2(StatusIs, code, message, "") {
  const absl::Status status = StatusOf(arg);
  *result_listener << "whose status is " << status;
  return static_cast<int>(status.code()) == static_cast<int>(code) &&
         testing::ExplainMatchResult(message, std::string(status.message()), result_listener);
}

template <typename Code>
auto StatusIs(Code code) {
  return StatusIs(code, testing::_);
}

MATCHER_P(IsOkAndHolds, value, "") {
  if (!arg.ok()) {
    *result_listener << "whose status is " << arg.status();
    return false;
  }
  return testing::ExplainMatchResult(value, *arg, result_listener);
}

}  // namespace ballpiston

#define EXPECT_OK(expression) EXPECT_THAT(expression, ::ballpiston::IsOk())
#define ASSERT_OK(expression) ASSERT_THAT(expression, ::ballpiston::IsOk())

// Declares or assigns the value of a StatusOr. Ends the test if it has no value.
#define ASSERT_OK_AND_ASSIGN(variable, expression)                                        \
  BALLPISTON_ASSERT_OK_AND_ASSIGN_(BALLPISTON_JOIN_(result_in_line_, __LINE__), variable, \
                                   expression)
#define BALLPISTON_ASSERT_OK_AND_ASSIGN_(result, variable, expression) \
  auto result = (expression);                                          \
  ASSERT_OK(result);                                                   \
  variable = *std::move(result)
#define BALLPISTON_JOIN_(a, b) BALLPISTON_JOIN_NOW_(a, b)
#define BALLPISTON_JOIN_NOW_(a, b) a##b
