// Properties that several targets share. All functions throw as Require does. Slow checks run for
// one input in sixteen.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "ballpiston/v1/spec.pb.h"
#include "core/ensemble/ensemble_spec.h"

namespace ballpiston::fuzz {

// The server can send the error: its details fit into gRPC's trailers, have a reason, and the
// client's library returns the same code and reason.
void RequireSendable(const absl::Status& error, const std::string& input);

// Each violation names a field that begins with `prefix`, and has a description.
void RequireNamed(const std::vector<FieldViolation>& violations, const std::string& prefix);

// An accepted specification has points with valid pairs, and converts to the core's form and to
// bytes and back without a change. A rejected one has named violations that can be sent. True if it
// was accepted.
bool RequireJudged(const v1::EnsembleSpec& spec, const std::string& input);

// The size and the token of a page of `list`, which begins at `first` without a token. An accepted
// page has a size and a start, and a token of this start gives the same start. For a rejected page
// the error can be sent.
void RequirePage(int32_t page_size, const std::string& page_token, const std::string& list,
                 int64_t first, const std::string& input);

}  // namespace ballpiston::fuzz
