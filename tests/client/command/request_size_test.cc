#include "client/command/request_size.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "ballpiston/v1/analytic.pb.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

using ::testing::HasSubstr;

TEST(RequestSize, AListOfAHundredThousandIsPermitted) {
  v1::EnsembleSpec spec;
  spec.mutable_grid()->mutable_rho()->Resize(100'000, 0.53);
  EXPECT_OK(CheckSize(spec, "spec"));
}

TEST(RequestSize, EveryLongerListIsNamedWithItsLength) {
  v1::EnsembleSpec spec;
  spec.mutable_grid()->mutable_rho()->Resize(1'000'000, 0.53);
  spec.mutable_grid()->mutable_delta()->Resize(100'001, 0.1);
  EXPECT_THAT(CheckSize(spec, "spec"),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       "spec.grid.rho: has 1000000 values; at most 100000 are permitted\n"
                       "spec.grid.delta: has 100001 values; at most 100000 are permitted"));
}

TEST(RequestSize, WithoutAPrefixFieldsAreNamedAlone) {
  v1::EvaluatePairsRequest request;
  request.mutable_beta()->Resize(100'001, 1);
  EXPECT_THAT(CheckSize(request, ""),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("beta: has 100001 values")));
}

// Negative whole numbers take ten bytes each.
v1::EnsembleSpec LargeSpec(int cells) {
  v1::EnsembleSpec spec;
  for (auto* list :
       {spec.mutable_grid()->mutable_rho(), spec.mutable_grid()->mutable_delta(),
        spec.mutable_grid()->mutable_epsilon(), spec.mutable_grid()->mutable_exponent()}) {
    list->Resize(100'000, 0.5);
  }
  spec.mutable_grid()->mutable_cells()->Resize(cells, -1);
  return spec;
}

TEST(RequestSize, ErrorOfATooLargeMessageNamesItsSize) {
  EXPECT_EQ(CheckSize(LargeSpec(100'000), "spec"),
            absl::InvalidArgumentError("spec: has 4200025 bytes; at most 4193280 are permitted"));
}

// The other fields of the request fit into the server's limit beside the specification.
TEST(RequestSize, TheLargestPermittedSpecFitsWithARequestId) {
  v1::CreateEnsembleJobRequest request;
  *request.mutable_spec() = LargeSpec(99'300);
  ASSERT_OK(CheckSize(request.spec(), "spec"));
  EXPECT_THAT(CheckSize(LargeSpec(99'400), "spec"), StatusIs(absl::StatusCode::kInvalidArgument));
  request.set_request_id("01234567-89ab-4def-8123-456789abcdef");
  EXPECT_LE(request.ByteSizeLong(), size_t{4} << 20);
}

}  // namespace
}  // namespace ballpiston::client
