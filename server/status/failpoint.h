// Named places at which a test can kill the server, as a power cut or the kernel would.
//
//   Failpoint("store.before_commit");
//
// Only the environment arms a failpoint: BALLPISTON_FAILPOINT=NAME:N. At the N-th pass of NAME,
// counted from 1 over all threads, the process kills itself with SIGKILL, so that nothing is
// flushed and no destructor runs. NAME:ready+N counts only passes after the server is ready. If the
// variable is unset, a pass costs one load and one branch. If the value has an unknown name or a
// number less than 1, the process exits at once with code 2, because the test would otherwise wait
// for ever. Thread-safe.
//
// BALLPISTON_FAILPOINT=crash-for-seed:SEED arms a crash of the engine instead (CrashForSeed).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace ballpiston::server {

// All failpoints, in the order of a job's life. Tests visit each of them.
inline constexpr std::array<std::string_view, 25> kFailpoints = {
    "create.in_transaction",    // the job's row is written, not committed
    "create.committed",         // the job's row is on disk; the run is not begun
    "create.before_answer",     // the run is begun; the client knows nothing
    "store.before_commit",      // a group of writes is in the transaction
    "store.after_commit",       // the group is on disk; no client has an answer
    "block.merged",             // a block is merged into its point, not recorded
    "checkpoint.before_write",  // the transaction has begun
    "cluster.written",          // a lease is in the folder, under a name that no worker sees
    "cluster.laid",             // a lease is in the folder; the server does not count it yet
    "cluster.submitted",        // Slurm has workers; the server knows nothing of them
    "cluster.file_reported",    // the scheduler has a file's chunks; few are on disk
    "point.before_record",      // all its blocks are merged
    "point.recorded",           // its result waits to be written
    "job.before_end",           // all its points are finished; its end is not recorded
    "job.end_recorded",         // its end waits to be written
    "job.ended",                // its end is on disk; no watch has it
    "cancel.in_transaction",    // CANCELLING is written, not committed
    "cancel.committed",         // CANCELLING is committed; the workers do not know
    "delete.in_transaction",    // the rows are gone, not committed
    "delete.committed",         // the deletion is on disk; the client knows nothing
    "sweep.in_transaction",     // some of a deleted job's results are gone, not committed
    "resume.job",               // after a restart: an unfinished job is resumed
    "resume.point",             // a point is resumed from its checkpoint
    "stop.before_flush",        // SIGTERM: the workers have stopped
    "stop.before_checkpoint"    // everything is written; the log is not yet copied into the store
};

inline constexpr std::string_view kCrashForSeed = "crash-for-seed";

namespace failpoint_internal {
extern const bool armed;
void Pass(std::string_view name);
void PassSeed(uint64_t seed);
}  // namespace failpoint_internal

inline void Failpoint(std::string_view name) {
  if (failpoint_internal::armed) [[unlikely]] {
    failpoint_internal::Pass(name);
  }
}

// Before blocks of a job with this seed, at least 1, are computed: the process dies of SIGSEGV, as
// if the engine had a fault, if the environment says so.
inline void CrashForSeed(uint64_t seed) {
  if (failpoint_internal::armed) [[unlikely]] {
    failpoint_internal::PassSeed(seed);
  }
}

// The server is ready: from now on passes of NAME:ready+N count.
void CountFailpointsOfReadyServer();

}  // namespace ballpiston::server
