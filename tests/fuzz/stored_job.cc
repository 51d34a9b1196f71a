// The message that the API makes from a job's row, with all its columns.
//
// Eight bytes each: state, times of creation, start and end, points, points done, samples, work;
// then one byte that says how long the specification is, the specification, the error.
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "absl/time/time.h"
#include "server/book/job_message.h"
#include "server/store/job_record.h"
#include "tests/fuzz/fuzz_target.h"

namespace ballpiston::fuzz {
namespace {

int64_t TakeInteger(std::string_view& bytes) {
  int64_t number = 0;
  const size_t size = std::min(bytes.size(), sizeof(number));
  std::memcpy(&number, bytes.data(), size);
  bytes.remove_prefix(size);
  return number;
}

std::string TakeText(std::string_view& bytes, size_t length) {
  const std::string text(bytes.substr(0, length));
  bytes.remove_prefix(text.size());
  return text;
}

server::JobRecord RowOf(std::string_view bytes) {
  server::JobRecord row;
  row.id = "0123456789abcdef";
  row.state = static_cast<server::JobState>(TakeInteger(bytes));
  row.create_time = absl::FromUnixNanos(TakeInteger(bytes));
  row.start_time = absl::FromUnixNanos(TakeInteger(bytes));
  row.end_time = absl::FromUnixNanos(TakeInteger(bytes));
  row.points = TakeInteger(bytes);
  row.numbers.points_done = TakeInteger(bytes);
  row.numbers.samples = std::bit_cast<double>(TakeInteger(bytes));
  row.numbers.work = std::bit_cast<double>(TakeInteger(bytes));
  const auto length = static_cast<unsigned char>(TakeText(bytes, 1)[0]);
  row.spec.rest = TakeText(bytes, length);
  row.error = std::string(bytes);
  return row;
}

void CheckStoredJob(const std::string& bytes) {
  const server::JobRecord row = RowOf(bytes);
  const v1::EnsembleJob job = server::JobMessage(row, row.numbers, 400);
  for (const auto& time : {job.create_time(), job.start_time(), job.end_time()}) {
    Require(time.nanos() >= 0 && time.nanos() < 1'000'000'000, "a time is one");
  }
  v1::EnsembleJob sent;
  Require(sent.ParseFromString(job.SerializeAsString()), "a row can be sent");
  Require(!server::HasEnded(job.state()) || !v1::EnsembleJob::State_Name(job.state()).empty(),
          "an end has a name");
}

std::vector<std::string> Rows() {
  return {std::string(65, '\1'), std::string(80, '\0'), std::string(200, '\x08')};
}

const Registration kStoredJob({.name = "stored_job", .check = CheckStoredJob, .made_seeds = Rows});

}  // namespace
}  // namespace ballpiston::fuzz
