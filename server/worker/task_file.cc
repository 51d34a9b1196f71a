#include "server/worker/task_file.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "ballpiston/storage/records.pb.h"
#include "server/convert/deterministic_bytes.h"
#include "server/worker/checked_file.h"

namespace ballpiston::server {
namespace {

absl::Status InFile(const std::string& path, const absl::Status& status) {
  return absl::Status(status.code(), absl::StrCat("file ", path, ": ", status.message()));
}

absl::StatusOr<storage::TaskFile> ReadRecord(const std::string& path) {
  const absl::StatusOr<std::string> payload = ReadCheckedFile(path, FileKind::kTasks);
  if (!payload.ok()) return payload.status();
  storage::TaskFile record;
  if (record.ParseFromString(*payload)) return record;
  return InFile(path, absl::DataLossError("its message cannot be read"));
}

absl::StatusOr<ArrayTask> TaskOf(const storage::TaskFile& file, size_t index) {
  if (index >= static_cast<size_t>(file.tasks_size())) {
    return absl::InvalidArgumentError(
        absl::StrCat("there is no task ", index, "; the file has ", file.tasks_size(), " tasks"));
  }
  ArrayTask task = {.array = file.array(), .task = index};
  for (const storage::Lease& record : file.tasks(static_cast<int>(index)).leases()) {
    absl::StatusOr<IdentifiedLease> lease = LeaseOfRecord(record);
    if (!lease.ok()) return lease.status();
    task.leases.push_back(*std::move(lease));
  }
  return task;
}

}  // namespace

absl::Status WriteTaskFile(const std::string& path, const std::string& array,
                           const std::vector<std::vector<IdentifiedLease>>& tasks) {
  storage::TaskFile file;
  file.set_array(array);
  for (const std::vector<IdentifiedLease>& leases : tasks) {
    storage::Task& task = *file.add_tasks();
    for (const auto& [job, lease] : leases) *task.add_leases() = LeaseRecord(lease, job);
  }
  return WriteCheckedFile(path, FileKind::kTasks, DeterministicBytes(file));
}

absl::StatusOr<ArrayTask> ReadTask(const std::string& path, size_t task) {
  const absl::StatusOr<storage::TaskFile> file = ReadRecord(path);
  if (!file.ok()) return file.status();
  absl::StatusOr<ArrayTask> found = TaskOf(*file, task);
  if (!found.ok()) return InFile(path, found.status());
  return found;
}

absl::StatusOr<std::vector<std::vector<IdentifiedLease>>> ReadTasks(const std::string& path) {
  const absl::StatusOr<storage::TaskFile> file = ReadRecord(path);
  if (!file.ok()) return file.status();
  std::vector<std::vector<IdentifiedLease>> tasks;
  for (size_t i = 0; i < static_cast<size_t>(file->tasks_size()); ++i) {
    absl::StatusOr<ArrayTask> task = TaskOf(*file, i);
    if (!task.ok()) return InFile(path, task.status());
    tasks.push_back(std::move(task->leases));
  }
  return tasks;
}

}  // namespace ballpiston::server
