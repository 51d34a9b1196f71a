#include "server/cluster/slurm_queue.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace ballpiston::server {
namespace {

constexpr size_t kMostIndex = 4'000'000;  // Slurm's own bound of MaxArraySize

// Reasons of Slurm 22.05. A task waits for an operator; quotas and limits of the number of jobs are
// not among them, because they pass.
constexpr std::array kForever = {absl::string_view("AccountNotAllowed"),
                                 absl::string_view("BadConstraints"),
                                 absl::string_view("InvalidAccount"),
                                 absl::string_view("InvalidQOS"),
                                 absl::string_view("JobHeldAdmin"),
                                 absl::string_view("JobHeldUser"),
                                 absl::string_view("JobLaunchFailure"),
                                 absl::string_view("PartitionConfig"),
                                 absl::string_view("PartitionDown"),
                                 absl::string_view("PartitionInactive"),
                                 absl::string_view("PartitionNodeLimit"),
                                 absl::string_view("PartitionTimeLimit"),
                                 absl::string_view("QOSMinCpuNotSatisfied"),
                                 absl::string_view("QOSNotAllowed"),
                                 absl::string_view("QOSTimeLimit"),
                                 absl::string_view("launch failed requeued held"),
                                 absl::string_view("launch_failed_requeued_held")};
// Limits of one job, such as QOSMaxWallDurationPerJobLimit.
constexpr absl::string_view kOfOneJob = "PerJobLimit";

bool IsWaiting(absl::string_view state) {
  return state == "PENDING" || state == "REQUEUED" || state == "REQUEUE_HOLD" ||
         state == "REQUEUE_FED" || state == "SPECIAL_EXIT" || state == "RESV_DEL_HOLD";
}

bool IsRunning(absl::string_view state) {
  return state == "RUNNING" || state == "COMPLETING" || state == "CONFIGURING" ||
         state == "SUSPENDED" || state == "STOPPED" || state == "SIGNALING" ||
         state == "RESIZING" || state == "STAGE_OUT";
}

// One item: "7", "0-3" or "10-20:5".
void AddIndices(absl::string_view item, size_t most, std::set<size_t>& indices) {
  const std::vector<absl::string_view> with_step = absl::StrSplit(item, absl::MaxSplits(':', 1));
  const std::vector<absl::string_view> ends = absl::StrSplit(with_step[0], absl::MaxSplits('-', 1));
  uint64_t first = 0, last = 0, step = 1;
  if (!absl::SimpleAtoi(ends.front(), &first) || !absl::SimpleAtoi(ends.back(), &last)) return;
  if (with_step.size() == 2 && (!absl::SimpleAtoi(with_step[1], &step) || step == 0)) return;
  step = std::min<uint64_t>(step, most + 1);  // the sum below does not overflow
  for (uint64_t i = first; i <= std::min<uint64_t>(last, most); i += step) indices.insert(i);
}

}  // namespace

std::set<size_t> ParseIndices(absl::string_view text, size_t most) {
  std::set<size_t> indices;
  const std::vector<absl::string_view> without_limit =
      absl::StrSplit(text, absl::MaxSplits('%', 1));
  for (const absl::string_view item : absl::StrSplit(without_limit[0], ',')) {
    AddIndices(item, most, indices);
  }
  return indices;
}

std::string IndicesText(const std::set<size_t>& indices) {
  std::string text;
  for (auto first = indices.begin(); first != indices.end();) {
    auto last = first;
    for (auto next = std::next(last); next != indices.end() && *next == *last + 1; ++next) {
      last = next;
    }
    absl::StrAppend(&text, text.empty() ? "" : ",", *first);
    if (last != first) absl::StrAppend(&text, "-", *last);
    first = std::next(last);
  }
  return text;
}

std::map<std::string, QueuedArray> ParseQueue(absl::string_view lines, absl::string_view prefix) {
  std::map<std::string, QueuedArray> arrays;
  for (const absl::string_view line : absl::StrSplit(lines, '\n', absl::SkipEmpty())) {
    const std::vector<absl::string_view> fields = absl::StrSplit(line, absl::MaxSplits('|', 4));
    if (fields.size() != 5 || !absl::StartsWith(fields[2], prefix)) continue;
    const bool waits = IsWaiting(fields[3]);
    if (!waits && !IsRunning(fields[3])) continue;
    QueuedArray& array = arrays[std::string(fields[2])];
    array.id = std::string(fields[0]);
    (waits ? array.waiting : array.running).merge(ParseIndices(fields[1], kMostIndex));
    if (waits) array.reasons.emplace(fields[4]);
  }
  return arrays;
}

bool WaitsForever(absl::string_view reason) {
  return absl::EndsWith(reason, kOfOneJob) ||
         std::find(kForever.begin(), kForever.end(), reason) != kForever.end();
}

}  // namespace ballpiston::server
