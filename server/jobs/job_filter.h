// Which jobs a list contains: those that match all parts of a filter.
#pragma once

#include <set>

#include "absl/time/time.h"
#include "ballpiston/v1/spec.pb.h"
#include "server/store/job_record.h"

namespace ballpiston::server {

struct JobFilter {
  std::set<JobState> states = {};                           // empty: any
  std::set<v1::EnsembleSpec::Experiment> experiments = {};  // empty: any
  absl::Time since = absl::InfinitePast();                  // the job was created then or later

  bool MatchesState(JobState state) const;
  // Whether the job matches all parts. A specification that cannot be read has no experiment.
  bool Matches(const JobRecord& record) const;
};

}  // namespace ballpiston::server
