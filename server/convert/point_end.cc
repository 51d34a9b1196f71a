#include "server/convert/point_end.h"

#include <optional>

#include "absl/status/status.h"
#include "server/convert/compressed.h"
#include "server/convert/fold_record.h"

namespace ballpiston::server {

std::string EndBytes(const FoldState& state) { return Compressed(FoldRecordBytes(state)); }

absl::StatusOr<FoldState> EndFromBytes(const std::string& bytes) {
  const std::optional<std::string> plain = Uncompressed(bytes);
  if (plain) return FoldStateFromBytes(*plain);
  return absl::DataLossError("the stored end of a point cannot be read");
}

}  // namespace ballpiston::server
