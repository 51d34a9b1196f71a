// The text of the API's tokens: page tokens, and the resume tokens of watches
// (proto/ballpiston/storage/tokens.proto). Pure functions.
#pragma once

#include <optional>
#include <string>

#include "absl/strings/escaping.h"

namespace ballpiston::server {

template <typename Token>
std::string TokenText(const Token& token) {
  return absl::WebSafeBase64Escape(token.SerializeAsString());
}

// Empty if the text is not a token. A text that no server made may still be one.
template <typename Token>
std::optional<Token> ParseToken(const std::string& text) {
  std::string bytes;
  Token token;
  if (!absl::WebSafeBase64Unescape(text, &bytes) || !token.ParseFromString(bytes)) {
    return std::nullopt;
  }
  return token;
}

}  // namespace ballpiston::server
