// What has to hold of several kinds of input. All throw what Require does. What takes much longer
// than what it judges is done for one input in sixteen.
#ifndef BALLPISTON_TESTS_FUZZ_RULES_H_
#define BALLPISTON_TESTS_FUZZ_RULES_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "ballpiston/v1/spec.pb.h"
#include "core/ensemble/ensemble_spec.h"

namespace ballpiston::fuzz {

// An error that a client can be sent: its details fit into gRPC's trailers, say a reason, and come
// back from the client's library with the same code and reason.
void RequireSendable(const absl::Status& error, const std::string& input);

// Each names a field that begins with `prefix`, and says something.
void RequireNamed(const std::vector<FieldViolation>& violations, const std::string& prefix);

// Accepted: it has points that make pairs, and comes back from the core's form and from bytes as it
// went. Refused: every violation is named and they can be sent. True if it was accepted.
bool RequireJudged(const v1::EnsembleSpec& spec, const std::string& input);

// The size and the token of a page of `list`, which begins at `first` without a token. Accepted:
// the page has a size and a start, and a token made of the start leads back there. Refused: the
// error can be sent.
void RequirePage(int32_t page_size, const std::string& page_token, const std::string& list,
                 int64_t first, const std::string& input);

}  // namespace ballpiston::fuzz

#endif  // BALLPISTON_TESTS_FUZZ_RULES_H_
