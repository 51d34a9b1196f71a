// Messages that tests write in the text format of Protocol Buffers.
#pragma once

#include <google/protobuf/text_format.h>

#include <string>

#include "gtest/gtest.h"

namespace ballpiston {

// A later value of a field replaces an earlier one, and values of lists are added.
template <typename Message>
Message FromText(const std::string& text) {
  Message message;
  EXPECT_TRUE(google::protobuf::TextFormat::MergeFromString(text, &message)) << text;
  return message;
}

}  // namespace ballpiston
