#include "server/book/job_list.h"

#include <algorithm>
#include <utility>

#include "server/convert/timestamp.h"

namespace ballpiston::server {
namespace {

// Upper bound of the encoded size of the job's message: the numbers in memory and the time of
// expiry take less than the constant.
size_t MostBytesOf(const JobRecord& record) { return 512 + record.job.ByteSizeLong(); }

// Collects the jobs of one page, newest first, until one of the query's bounds is reached.
class PageReader {
 public:
  explicit PageReader(const JobsQuery& query) : query_(query) {}

  // False: the page ends before this job.
  bool Take(JobRecord record) {
    const size_t bytes = MostBytesOf(record);
    if (HasReadEnough(bytes) || IsFull()) return End();
    const bool matches = query_.filter.Matches(record);
    if (matches && !HasRoom(bytes)) return End();
    ++read_;
    bytes_read_ += bytes;
    last_read_ = record.sequence;
    if (!matches) return true;
    bytes_ += bytes;
    page_.jobs.push_back(std::move(record));
    return true;
  }

  PageOfJobs<JobRecord> page() && { return std::move(page_); }

 private:
  bool IsFull() const { return page_.jobs.size() == static_cast<size_t>(query_.max_jobs); }
  bool HasRoom(size_t bytes) const {
    return page_.jobs.empty() || bytes_ + bytes <= query_.max_bytes;
  }
  bool HasReadEnough(size_t bytes) const {
    return read_ > 0 &&
           (read_ == query_.max_jobs_read || bytes_read_ + bytes > query_.max_bytes_read);
  }
  bool End() {
    page_.next_before = last_read_;
    return false;
  }

  const JobsQuery& query_;
  PageOfJobs<JobRecord> page_;
  size_t bytes_ = 0;  // of its jobs
  int read_ = 0;      // jobs read, matching or not
  size_t bytes_read_ = 0;
  int64_t last_read_ = 0;
};

}  // namespace

bool JobFilter::MatchesState(JobState state) const {
  return states.empty() || states.contains(state);
}

bool JobFilter::Matches(const JobRecord& record) const {
  const v1::EnsembleJob& job = record.job;
  const auto has_label = [&job](const auto& label) {
    const auto found = job.labels().find(label.first);
    return found != job.labels().end() && found->second == label.second;
  };
  return MatchesState(job.state()) && TimeOf(job.create_time()) >= since &&
         std::ranges::all_of(labels, has_label) &&
         (experiments.empty() || experiments.contains(job.spec().experiment()));
}

PageOfJobs<JobRecord> ReadPage(Database& database, const std::optional<std::string>& principal,
                               const JobsQuery& query) {
  PageReader reader(query);
  ReadJobs(database, principal, query.before, query.grid,
           [&](JobRecord record) { return reader.Take(std::move(record)); });
  return std::move(reader).page();
}

}  // namespace ballpiston::server
