#include "tests/fuzz/mutation.h"

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"

namespace ballpiston::fuzz {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;
using google::protobuf::TextFormat;

constexpr size_t kLongestList = 12;

using Double = std::numeric_limits<double>;
constexpr double kInf = Double::infinity(), kNan = Double::quiet_NaN();
constexpr double kMax = Double::max(), kMin = Double::min(), kTiny = Double::denorm_min();
constexpr double kPaper = 0.529561127988977, kAboveHalf = 0.50000000000000011;
constexpr double kBelowSqrt = 0.70710678118654746, kAboveSqrt = 0.70710678118654757;

// Bounds of domains, and numbers outside every domain.
constexpr double kNumbers[] = {0,    0.1,   0.25,   0.5,        1.0 / 6,    0.53,       0.6,  0.7,
                               1,    2,     60,     1e3,        1e6,        1e300,      kMax, kInf,
                               kNan, -kInf, kPaper, kAboveHalf, kBelowSqrt, kAboveSqrt, -0.0, -1,
                               0.01, 1e-3,  1e-5,   1e-9,       1e-300,     kMin,       kTiny};

constexpr int64_t kMost = std::numeric_limits<int64_t>::max();
constexpr int64_t kLeast = std::numeric_limits<int64_t>::min();
constexpr int64_t kMostNanos = 999'999'999, kTrillion = 1'000'000'000'000, kPast = kTrillion + 1;
constexpr int64_t kIntegers[] = {0,         1,     2,         -1,        5,      7,
                                 50,        100,   1000,      1001,      10'000, kMostNanos,
                                 kTrillion, kPast, INT32_MAX, INT32_MIN, kMost,  kLeast};

// Nothing, text that is not UTF-8 and text that is, cells, tokens of pages, names, an id, a type.
const std::vector<std::string> kWords = absl::StrSplit(
    " - \xff \xc3\xa9 4x3 1000001 am9iczo1 am9iczo1MA ensembleJobs/ ensembleJobs/0123456789abcdef "
    "123e4567-e89b-12d3-a456-426614174000 type.googleapis.com/google.rpc.ErrorInfo",
    ' ');

double Number(Dice& dice, double now) {
  switch (dice.Below(4)) {
    case 0:
      return kNumbers[dice.Below(std::size(kNumbers))];
    case 1:
      return std::nextafter(now, dice.OneIn(2) ? -1e308 : 1e308);
    case 2:
      return now * (static_cast<double>(dice.Below(2000)) / 1000);
    default:
      return dice.OneIn(8) ? std::bit_cast<double>(dice.Bits())
                           : static_cast<double>(dice.Below(1 << 20)) * 0x1p-20;
  }
}

int64_t Integer(Dice& dice, int64_t now) {
  switch (dice.Below(3)) {
    case 0:
      return kIntegers[dice.Below(std::size(kIntegers))];
    case 1:
      return static_cast<int64_t>(static_cast<uint64_t>(now) + (dice.OneIn(2) ? 1u : ~uint64_t{0}));
    default:
      return static_cast<int64_t>(dice.Bits() >> dice.Below(64));
  }
}

// A new text. Both `now` and the result are in quotes and escaped.
std::string Text(Dice& dice, const std::string& now) {
  std::string text;
  if (dice.OneIn(3)) {
    text = kWords[dice.Below(kWords.size())];
  } else {
    if (!now.empty()) absl::CUnescape(now.substr(1, now.size() - 2), &text);
    MutateBytes(dice, text);
  }
  return absl::StrCat("\"", absl::CEscape(text), "\"");
}

// A new value of the field, often near the value `now`; both in the text format.
std::string NewValue(Dice& dice, const FieldDescriptor& field, const std::string& now) {
  double number;
  int64_t integer;
  if (!absl::SimpleAtoi(now, &integer)) integer = 0;
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      if (!absl::SimpleAtod(now, &number)) number = 0.55;
      return absl::StrFormat("%.17g", Number(dice, number));
    case FieldDescriptor::CPPTYPE_ENUM:
      return absl::StrCat(static_cast<int>(dice.Below(9)) - 1);
    case FieldDescriptor::CPPTYPE_BOOL:
      return dice.OneIn(2) ? "true" : "false";
    case FieldDescriptor::CPPTYPE_STRING:
      return Text(dice, now);
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return "{}";
    case FieldDescriptor::CPPTYPE_INT32:
      return absl::StrCat(static_cast<int32_t>(Integer(dice, integer)));
    case FieldDescriptor::CPPTYPE_UINT64:
      return absl::StrCat(static_cast<uint64_t>(Integer(dice, integer)));
    default:
      return absl::StrCat(Integer(dice, integer));
  }
}

// Takes an element out of the list, and returns it in the text format.
std::string Taken(const FieldDescriptor& field, int index, Message& message) {
  const Reflection& reflection = *message.GetReflection();
  std::string taken;
  TextFormat::PrintFieldValueToString(message, &field, index, &taken);
  reflection.SwapElements(&message, &field, index, reflection.FieldSize(message, &field) - 1);
  reflection.RemoveLast(&message, &field);
  return taken;
}

}  // namespace

void MutateBytes(Dice& dice, std::string& bytes) {
  const size_t at = dice.Below(bytes.size() + 1);
  const auto random = static_cast<char>(dice.Bits());
  switch (dice.Below(6)) {
    case 0:
      bytes.insert(at, 1, random);
      return;
    case 1:
      bytes.insert(at, kWords[dice.Below(std::size(kWords))]);
      return;
    case 2:
      bytes.insert(at, std::to_string(Integer(dice, 0)));
      return;
    case 3:
      bytes.erase(at, 1 + dice.Below(4));
      return;
    case 4:
      bytes.insert(at, bytes.substr(dice.Below(bytes.size() + 1), dice.Below(16)));
      return;
    default:
      if (at < bytes.size())
        bytes[at] = dice.OneIn(2) ? random : static_cast<char>(bytes[at] ^ (1 << dice.Below(8)));
  }
}

void MutateMessage(Dice& dice, Message& message) {
  const int fields = message.GetDescriptor()->field_count();
  if (fields == 0) return;
  const FieldDescriptor& field =
      *message.GetDescriptor()->field(static_cast<int>(dice.Below(static_cast<size_t>(fields))));
  const Reflection& reflection = *message.GetReflection();
  if (dice.OneIn(16)) return reflection.ClearField(&message, &field);
  const bool has_messages = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
  std::string now;
  if (field.is_repeated()) {
    const auto size = static_cast<size_t>(reflection.FieldSize(message, &field));
    if (size > 0 && (!dice.OneIn(4) || size == kLongestList)) {
      const int index = static_cast<int>(dice.Below(size));
      if (has_messages && !dice.OneIn(4)) {
        return MutateMessage(dice, *reflection.MutableRepeatedMessage(&message, &field, index));
      }
      now = Taken(field, index, message);
      if (dice.OneIn(4)) return;
    }
  } else if (has_messages) {
    return MutateMessage(dice, *reflection.MutableMessage(&message, &field));
  } else {
    TextFormat::PrintFieldValueToString(message, &field, -1, &now);
  }
  // A value that the field cannot have changes nothing.
  TextFormat::Parser().ParseFieldValueFromString(NewValue(dice, field, now), &field, &message);
}

bool MutateFields(Dice& dice, const Message& kind, std::string& bytes) {
  const std::unique_ptr<Message> message(kind.New());
  if (!message->ParsePartialFromString(bytes)) return false;
  for (size_t changes = 1 + dice.Below(4); changes > 0; --changes) MutateMessage(dice, *message);
  bytes = message->SerializePartialAsString();
  return true;
}

}  // namespace ballpiston::fuzz
