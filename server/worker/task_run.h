// Runs one task of a job array: reads the files that an earlier run of the task left, computes the
// missing chunks, and writes them in files.
#pragma once

#include <functional>
#include <limits>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "server/worker/task_file.h"

namespace ballpiston::server {

struct TaskRunOptions {
  std::string folder = {};       // for the chunk files
  double flush_seconds = 30;     // processor time between two files, if a chunk is complete
  double retry_seconds = 5;      // between two attempts to use a folder that is full or not there
  double give_up_seconds = 120;  // sum of these waits
  // Bytes. A lease that needs more is left out: its memory would end the task (MemoryOf).
  double memory = std::numeric_limits<double>::infinity();
};

// One line for people, without the line end.
using Report = std::function<void(absl::string_view line)>;

// Writes a final file when the task has nothing left to compute. Also OK if stop was requested:
// then the complete chunks are in files. The stop source gets a request when the folder cannot be
// used; the error is that of ListChunkFiles or WriteChunkFile.
absl::Status RunTask(const ArrayTask& task, const TaskRunOptions& options, std::stop_source stop,
                     const Report& report);

}  // namespace ballpiston::server
