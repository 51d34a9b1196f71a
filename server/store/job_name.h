// Resource names: ensembleJobs/{id}, where an id is 1 to 63 of [a-z0-9-], and
// ensembleJobs/{id}/results/{index}. Pure functions, except RandomId.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace ballpiston::server {

std::string JobName(const std::string& id);
std::string ResultName(const std::string& job_id, int64_t point);

// Empty unless `name` is the name of a job.
std::optional<std::string> JobIdOf(const std::string& name);

struct ResultId {
  std::string job;
  int64_t point = 0;
};

// Empty unless `name` is the name of a result.
std::optional<ResultId> ResultIdOf(const std::string& name);

// 16 random hexadecimal digits.
std::string RandomId();

}  // namespace ballpiston::server
