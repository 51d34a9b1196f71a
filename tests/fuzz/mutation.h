// Random changes of inputs: of bytes, and of messages field by field, which get past the parser.
#pragma once

#include "google/protobuf/message.h"
#include "tests/support/dice.h"
#include "tests/support/preamble.h"

namespace ballpiston::fuzz {

// One flip, insertion, deletion, repetition or number of interest.
void MutateBytes(Dice& dice, std::string& bytes);

// Changes one field of the message or of a message in it: sets, clears, extends or shortens it, or
// moves it to the edge of its domain.
void MutateMessage(Dice& dice, google::protobuf::Message& message);

// Changes one to four fields of a message of this kind. False, and no change, if the bytes are not
// such a message.
bool MutateFields(Dice& dice, const google::protobuf::Message& kind, std::string& bytes);

}  // namespace ballpiston::fuzz
