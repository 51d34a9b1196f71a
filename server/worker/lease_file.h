// The file of a lease, and its names. The file begins with the lease; the worker appends the chunks
// that it has computed; at its end the worker moves the file to done/. So the file alone proves
// which chunks are whose, also to a later process of the server.
//
// Each part of the file is a message of storage/records.proto as a stream in gzip's format, whose
// checksum proves that it is complete (convert/compressed.h). The lease's message has its point as
// a question: one point, by a model that takes samples. An experiment that is created from the
// message has the same plan, random numbers and bits as the lease's experiment. The folder belongs
// to the server's user. So reading checks the engine version and the question, but not the chunks
// and their states.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "ballpiston/storage/records.pb.h"
#include "server/compute/lease.h"

namespace ballpiston::server {

// How a worker has ended with a lease.
enum class Outcome {
  kFinished,  // every chunk that the lease needs is in the file
  kReturned,  // the worker had to end
  kLost,      // the worker was silent for too long; the server has moved the file
  kCrashed,   // the engine killed the worker
  kNoMemory,  // the lease needs more memory than the worker may use
};

// The server writes one file at a time.
inline constexpr char kLeaseBeingWritten[] = "todo/.new";

// "LEASE", "LEASE.WORKER" or "LEASE.WORKER.OUTCOME".
struct LeaseFileName {
  std::string lease;
  std::string worker = {};
  std::optional<Outcome> outcome = {};

  std::string Todo() const { return "todo/" + lease; }
  std::string Taken() const { return "taken/" + lease + "." + worker; }
  std::string Done(Outcome how) const;
};

// A file's name without its folder. Empty if it is not the name of a lease's file in that folder.
std::optional<LeaseFileName> ParseTaken(absl::string_view name);
std::optional<LeaseFileName> ParseDone(absl::string_view name);

// The contents of the first part of a lease's file.
struct LeaseFile {
  std::string server;  // its identity
  // `run` and `generation` name the job, whose engine version is this program's. The spec is a
  // OnePointSpec, and `point` is the point's index in the job's grid. The message leaves out the
  // other fields of the lease, such as numbers and attempts.
  Lease lease;
  double touch_seconds = 20;  // the worker updates the file's time at this interval
};

// The lease has chunks, and its spec has no budget.
storage::Lease LeaseRecord(const Lease& lease, const std::string& server, double touch_seconds);

// UNIMPLEMENTED with both versions if the lease is of another engine version. DATA_LOSS if this
// engine cannot answer the question.
absl::StatusOr<LeaseFile> LeaseOfRecord(const storage::Lease& record);

std::string BytesOf(const storage::Lease& lease);
// The complete chunks, and the seconds.
std::string BytesOf(const LeaseReport& report);

// Each of these reads one message and removes it from `bytes`. Errors of TakeCompressed and
// LeaseOfRecord; DATA_LOSS if the message cannot be read.
absl::StatusOr<LeaseFile> TakeLease(absl::string_view& bytes);
using LeaseReader = std::function<absl::StatusOr<LeaseFile>(absl::string_view& bytes)>;
absl::StatusOr<LeaseReport> TakeReport(absl::string_view& bytes);

}  // namespace ballpiston::server
