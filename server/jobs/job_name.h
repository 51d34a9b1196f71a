// Resource names: ensembleJobs/{id}, where an id is 1 to 63 of [a-z0-9-]. Pure functions.
#ifndef BALLPISTON_SERVER_JOBS_JOB_NAME_H_
#define BALLPISTON_SERVER_JOBS_JOB_NAME_H_

#include <optional>
#include <string>

namespace ballpiston::server {

std::string JobName(const std::string& id);

// Empty unless `name` is a job's.
std::optional<std::string> JobIdOf(const std::string& name);

// 16 hexadecimal digits that nobody had before.
std::string RandomId();

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_JOBS_JOB_NAME_H_
