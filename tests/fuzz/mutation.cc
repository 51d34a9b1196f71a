#include "tests/fuzz/mutation.h"

namespace ballpiston::fuzz {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr int kLongestList = 12;

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

std::string Text(Dice& dice, std::string now) {
  if (dice.OneIn(3)) return kWords[dice.Below(kWords.size())];
  MutateBytes(dice, now);
  return now;
}

// ---- one field ----

// Sets the field, or with `adds` adds an element to the list.
void SetOrAdd(Dice& dice, const FieldDescriptor& field, bool adds, Message& message) {
  const Reflection& r = *message.GetReflection();
  Message* const m = &message;
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return adds ? r.AddDouble(m, &field, Number(dice, 0.55))
                  : r.SetDouble(m, &field, Number(dice, r.GetDouble(message, &field)));
    case FieldDescriptor::CPPTYPE_INT64:
      return adds ? r.AddInt64(m, &field, Integer(dice, 0))
                  : r.SetInt64(m, &field, Integer(dice, r.GetInt64(message, &field)));
    case FieldDescriptor::CPPTYPE_UINT64: {
      const auto number = static_cast<uint64_t>(Integer(dice, 0));
      return adds ? r.AddUInt64(m, &field, number) : r.SetUInt64(m, &field, number);
    }
    case FieldDescriptor::CPPTYPE_INT32: {
      const auto number =
          static_cast<int32_t>(Integer(dice, adds ? 0 : r.GetInt32(message, &field)));
      return adds ? r.AddInt32(m, &field, number) : r.SetInt32(m, &field, number);
    }
    case FieldDescriptor::CPPTYPE_ENUM: {
      const int number = static_cast<int>(dice.Below(9)) - 1;
      return adds ? r.AddEnumValue(m, &field, number) : r.SetEnumValue(m, &field, number);
    }
    case FieldDescriptor::CPPTYPE_BOOL:
      return adds ? r.AddBool(m, &field, dice.OneIn(2)) : r.SetBool(m, &field, dice.OneIn(2));
    case FieldDescriptor::CPPTYPE_STRING:
      return adds ? r.AddString(m, &field, Text(dice, ""))
                  : r.SetString(m, &field, Text(dice, r.GetString(message, &field)));
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return MutateMessage(dice, adds ? *r.AddMessage(m, &field) : *r.MutableMessage(m, &field));
    default:
      return;  // field types that the project does not use
  }
}

// Adds, removes, exchanges or changes an element.
void MutateList(Dice& dice, const FieldDescriptor& field, Message& message) {
  const Reflection& reflection = *message.GetReflection();
  const int size = reflection.FieldSize(message, &field);
  const size_t what = dice.Below(8);
  const bool adds = what < 2, removes = what == 2, exchanges = what == 3;  // else: changes
  if (size == 0 || (adds && size < kLongestList)) {
    return SetOrAdd(dice, field, /*adds=*/true, message);
  }
  const int index = static_cast<int>(dice.Below(static_cast<size_t>(size)));
  if (exchanges) return reflection.SwapElements(&message, &field, index, size - 1);
  if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && !removes) {
    return MutateMessage(dice, *reflection.MutableRepeatedMessage(&message, &field, index));
  }
  if (field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE && !removes) {
    const double now = reflection.GetRepeatedDouble(message, &field, index);
    return reflection.SetRepeatedDouble(&message, &field, index, Number(dice, now));
  }
  // An element of any other type is replaced by a new one.
  reflection.SwapElements(&message, &field, index, size - 1);
  reflection.RemoveLast(&message, &field);
  if (removes) return;
  SetOrAdd(dice, field, /*adds=*/true, message);
  reflection.SwapElements(&message, &field, index, size - 1);
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
  if (field.is_map()) {
    if (message.GetReflection()->FieldSize(message, &field) < kLongestList) {
      SetOrAdd(dice, field, /*adds=*/true, message);
    }
    return;
  }
  if (dice.OneIn(16)) return message.GetReflection()->ClearField(&message, &field);
  if (field.is_repeated()) return MutateList(dice, field, message);
  SetOrAdd(dice, field, /*adds=*/false, message);
}

bool MutateFields(Dice& dice, const Message& kind, std::string& bytes) {
  const std::unique_ptr<Message> message(kind.New());
  if (!message->ParsePartialFromString(bytes)) return false;
  for (size_t changes = 1 + dice.Below(4); changes > 0; --changes) MutateMessage(dice, *message);
  bytes = message->SerializePartialAsString();
  return true;
}

}  // namespace ballpiston::fuzz
