#include <set>

#include "gtest/gtest.h"
#include "server/convert/method.h"

namespace ballpiston::server {
namespace {

using Message = v1::MethodMeasurement;

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

TEST(MethodMessage, EachMethodHasItsValueAndEachValueItsMethod) {
  EXPECT_EQ(MessagesOf(Method::kClosedForm, &MethodMessage),
            NumbersOf(*Message::Method_descriptor()));
}

TEST(MethodMessage, EachQuantityHasItsValueAndEachValueItsQuantity) {
  EXPECT_EQ(MessagesOf(Quantity::kTrajectory, &QuantityMessage),
            NumbersOf(*Message::Quantity_descriptor()));
}

TEST(MethodMessage, AMethodKeepsItsMeaning) {
  EXPECT_EQ(MethodMessage(Method::kFixedStep), Message::FIXED_STEP);
  EXPECT_EQ(MethodMessage(Method::kReferenceSingle), Message::BILLIARD_REFERENCE_SINGLE);
  EXPECT_EQ(MethodMessage(Method::kReference), Message::BILLIARD_REFERENCE);
  EXPECT_EQ(MethodMessage(Method::kReferenceLongDouble), Message::BILLIARD_REFERENCE_LONG_DOUBLE);
  EXPECT_EQ(MethodMessage(Method::kReferenceQuadruple), Message::BILLIARD_REFERENCE_QUADRUPLE);
  EXPECT_EQ(MethodMessage(Method::kLanes), Message::BILLIARD);
  EXPECT_EQ(MethodMessage(Method::kLanesSingle), Message::BILLIARD_SINGLE);
  EXPECT_EQ(MethodMessage(Method::kClosedForm), Message::CLOSED_FORM);
  EXPECT_EQ(QuantityMessage(Quantity::kMeanFreeTime), Message::MEAN_FREE_TIME);
  EXPECT_EQ(QuantityMessage(Quantity::kIngoingLaw), Message::INGOING_LAW);
  EXPECT_EQ(QuantityMessage(Quantity::kTrajectory), Message::TRAJECTORY);
}

TEST(MethodMessage, AMeasurementIsToldWhole) {
  const Message message = MeasurementMessage({.method = Method::kFixedStep,
                                              .time_step = 0.25,
                                              .quantity = Quantity::kTrajectory,
                                              .samples = 5'000'000'000,
                                              .wall_hits = 6'000'000'000,
                                              .work = 1.5,
                                              .value = -0.125,
                                              .statistical_error = 0.0625});
  EXPECT_EQ(message.method(), Message::FIXED_STEP);
  EXPECT_EQ(message.time_step(), 0.25);
  EXPECT_EQ(message.quantity(), Message::TRAJECTORY);
  EXPECT_EQ(message.samples(), 5'000'000'000u);
  EXPECT_EQ(message.wall_hits(), 6'000'000'000u);
  EXPECT_EQ(message.work(), 1.5);
  EXPECT_EQ(message.value(), -0.125);
  EXPECT_EQ(message.statistical_error(), 0.0625);
}

}  // namespace
}  // namespace ballpiston::server
