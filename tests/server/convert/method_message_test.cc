#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/convert/method.h"
#include "tests/server/requests.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Measurement = v1::MethodMeasurement;

// The core's values are 0, 1, 2, ... to the last one; the conversion gives UNSPECIFIED for the
// number after it.
template <typename Value, typename Conversion>
std::set<int> MessagesOf(Value last, Conversion conversion) {
  std::set<int> messages;
  for (int i = 0; i <= static_cast<int>(last); ++i) {
    messages.insert(conversion(static_cast<Value>(i)));
  }
  EXPECT_EQ(messages.size(), static_cast<size_t>(last) + 1) << "two values have one message";
  EXPECT_EQ(conversion(static_cast<Value>(static_cast<int>(last) + 1)), 0) << "not the last value";
  return messages;
}

std::set<int> NumbersOf(const google::protobuf::EnumDescriptor& descriptor) {
  std::set<int> numbers;
  for (int i = 0; i < descriptor.value_count(); ++i) {
    if (descriptor.value(i)->number() != 0) numbers.insert(descriptor.value(i)->number());
  }
  return numbers;
}

TEST(MethodMessage, EachMethodHasOneMessageAndEachMessageOneMethod) {
  EXPECT_EQ(MessagesOf(Method::kSpectrum, &MethodMessage),
            NumbersOf(*Measurement::Method_descriptor()));
}

TEST(MethodMessage, EachQuantityHasOneMessageAndEachMessageOneQuantity) {
  EXPECT_EQ(MessagesOf(Quantity::kRelaxationTime, &QuantityMessage),
            NumbersOf(*Measurement::Quantity_descriptor()));
}

TEST(MethodMessage, MethodsKeepTheirMeaning) {
  EXPECT_EQ(MethodMessage(Method::kFixedStep), Measurement::FIXED_STEP);
  EXPECT_EQ(MethodMessage(Method::kReferenceSingle), Measurement::BILLIARD_REFERENCE_SINGLE);
  EXPECT_EQ(MethodMessage(Method::kReference), Measurement::BILLIARD_REFERENCE);
  EXPECT_EQ(MethodMessage(Method::kReferenceLongDouble),
            Measurement::BILLIARD_REFERENCE_LONG_DOUBLE);
  EXPECT_EQ(MethodMessage(Method::kReferenceQuadruple), Measurement::BILLIARD_REFERENCE_QUADRUPLE);
  EXPECT_EQ(MethodMessage(Method::kLanes), Measurement::BILLIARD);
  EXPECT_EQ(MethodMessage(Method::kLanesSingle), Measurement::BILLIARD_SINGLE);
  EXPECT_EQ(MethodMessage(Method::kClosedForm), Measurement::CLOSED_FORM);
  EXPECT_EQ(MethodMessage(Method::kMarkov), Measurement::MARKOV);
  EXPECT_EQ(MethodMessage(Method::kSpectrum), Measurement::SPECTRUM);
  EXPECT_EQ(QuantityMessage(Quantity::kMeanFreeTime), Measurement::MEAN_FREE_TIME);
  EXPECT_EQ(QuantityMessage(Quantity::kIngoingLaw), Measurement::INGOING_LAW);
  EXPECT_EQ(QuantityMessage(Quantity::kTrajectory), Measurement::TRAJECTORY);
  EXPECT_EQ(QuantityMessage(Quantity::kRelaxationTime), Measurement::RELAXATION_TIME);
}

TEST(MethodMessage, RelaxationIsMeasuredAtTheRequestedDeltas) {
  v1::CompareMethodsRequest request = SomeComparison();
  request.add_relaxation_delta(0.3);
  request.add_relaxation_delta(0.01);
  const CheckedComparison checked = CheckComparison(request);
  EXPECT_THAT(checked.violations, IsEmpty());
  EXPECT_THAT(checked.spec.relaxation_deltas, ElementsAre(0.3, 0.01));
}

// The bound on delta, (1 - lambda)/2, is 0.32 at rho = 0.53, 0.039 at 0.68 and 0.010 at 0.7.
TEST(MethodMessage, WithoutADeltaRelaxationIsMeasuredAtTheUsualOnesThatRhoPermits) {
  v1::CompareMethodsRequest request = SomeComparison();
  EXPECT_THAT(CheckComparison(request).spec.relaxation_deltas, ElementsAre(0.2, 0.1, 0.05, 0.025));
  request.set_delta(0.01);
  request.set_rho(0.68);
  EXPECT_THAT(CheckComparison(request).spec.relaxation_deltas, ElementsAre(0.025));
  request.set_rho(0.7);
  EXPECT_THAT(CheckComparison(request).spec.relaxation_deltas, IsEmpty());
  EXPECT_THAT(CheckComparison(request).violations, IsEmpty());
}

TEST(MethodMessage, EachDeltaOfRelaxationIsCheckedLikeDelta) {
  v1::CompareMethodsRequest request = SomeComparison();
  for (const double delta : {0.1, 0.4, 0.0, std::nan("")}) request.add_relaxation_delta(delta);
  const std::vector<FieldViolation> violations = CheckComparison(request).violations;
  ASSERT_EQ(violations.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(violations[i].field, "relaxation_delta[" + std::to_string(i + 1) + "]");
    EXPECT_THAT(violations[i].description, HasSubstr("0 < delta <="));
  }
}

TEST(MethodMessage, ThereAreAtMostEightDeltasOfRelaxation) {
  v1::CompareMethodsRequest request = SomeComparison();
  for (int i = 0; i < 8; ++i) request.add_relaxation_delta(0.1);
  EXPECT_THAT(CheckComparison(request).violations, IsEmpty());
  request.add_relaxation_delta(0.4);
  const std::vector<FieldViolation> violations = CheckComparison(request).violations;
  ASSERT_EQ(violations.size(), 1u);
  EXPECT_EQ(violations[0].field, "relaxation_delta");
  EXPECT_THAT(violations[0].description, HasSubstr("9 values"));
  EXPECT_THAT(violations[0].description, HasSubstr("at most 8"));
}

TEST(MethodMessage, AMessageHoldsAllOfAMeasurement) {
  const Measurement message = MeasurementMessage({.method = Method::kFixedStep,
                                                  .time_step = 0.25,
                                                  .quantity = Quantity::kTrajectory,
                                                  .delta = 0.375,
                                                  .samples = 5'000'000'000,
                                                  .wall_hits = 6'000'000'000,
                                                  .work = 1.5,
                                                  .value = -0.125,
                                                  .statistical_error = 0.0625});
  EXPECT_EQ(message.method(), Measurement::FIXED_STEP);
  EXPECT_EQ(message.time_step(), 0.25);
  EXPECT_EQ(message.quantity(), Measurement::TRAJECTORY);
  EXPECT_EQ(message.delta(), 0.375);
  EXPECT_EQ(message.samples(), 5'000'000'000u);
  EXPECT_EQ(message.wall_hits(), 6'000'000'000u);
  EXPECT_EQ(message.work(), 1.5);
  EXPECT_EQ(message.value(), -0.125);
  EXPECT_EQ(message.statistical_error(), 0.0625);
}

}  // namespace
}  // namespace ballpiston::server
