// Parses messages that tests write in the text format of Protocol Buffers.
#pragma once

#include <google/protobuf/text_format.h>

#include <string>

#include "gtest/gtest.h"

namespace ballpiston::client {

template <typename Message>
Message FromText(const std::string& text) {
  Message message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
  return message;
}

}  // namespace ballpiston::client
