// What the server tells its operator: one line each, on standard error. Thread-safe.
#ifndef BALLPISTON_SERVER_OBSERVABILITY_LOG_H_
#define BALLPISTON_SERVER_OBSERVABILITY_LOG_H_

#include "absl/strings/string_view.h"

namespace ballpiston::server {

void LogInfo(absl::string_view line);
void LogError(absl::string_view line);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_OBSERVABILITY_LOG_H_
