// Computes a part of a saved result again, on this machine and without a server, and compares.
//
// The file is a v1::SavedResult in JSON. The part is a random point, if it takes a few seconds:
// then every number of the point is compared, and the digest of each chunk of samples. Of a longer
// point it is a random chunk, which takes up to about a minute: then its digest is compared, and
// nothing is said of the estimates. The probability that one call finds a single altered chunk is
// therefore one over the number of chunks.
#pragma once

#include <string>

#include "absl/random/bit_gen_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ballpiston/v1/saved_result.pb.h"

namespace ballpiston::server {

// A sentence that says what was computed and found equal.
//   INVALID_ARGUMENT     the file cannot be read, or is not a saved result with a finished point
//   FAILED_PRECONDITION  another version of the engine computed it
//   DATA_LOSS            it is not what this engine computes; the message names the difference
absl::StatusOr<std::string> VerifyResult(const std::string& file, absl::BitGenRef random);

// A point is compared as a whole if it takes at most so many seconds of one core at nominal speed.
inline constexpr double kWholePointSeconds = 5;

// `whole_seconds`: in place of kWholePointSeconds.
absl::StatusOr<std::string> VerifySaved(const v1::SavedResult& saved, absl::BitGenRef random,
                                        double whole_seconds = kWholePointSeconds);

}  // namespace ballpiston::server
