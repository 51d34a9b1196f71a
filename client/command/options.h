// The values of all flags and arguments. Each verb sets some of them (verb_table.h); the others
// keep their defaults.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ballpiston/v1/analytic.pb.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/trace.pb.h"
#include "client/command/terminal.h"
#include "client/library/channel_security.h"
#include "client/library/client.h"
#include "client/output/point_output.h"
#include "client/output/progress.h"

namespace ballpiston::client {

enum class PageFormat { kText, kMan, kMarkdown };
enum class Completion { kBash, kZsh, kFish, kWords };

struct Options {
  v1::EnsembleSpec spec;
  std::string points_file;  // the table of points
  std::string spec_file;
  std::string again;  // the job whose specification is used again
  v1::EvaluatePairsRequest closed_forms;
  v1::TraceOrbitRequest trace;

  v1::CreateEnsembleJobRequest create;  // without the specification and the labels
  bool resume = false;
  std::vector<std::string> jobs;  // names, ensembleJobs/ID
  // Of a new job; else those that select jobs, or the changes of a job's labels.
  std::map<std::string, std::string> labels;
  std::string command;  // to run when a watched job ends
  bool any = false;     // a watch of several jobs ends with the first of them
  bool yes = false;     // act on all selected jobs without a question
  bool undo = false;    // of pin
  v1::ListEnsembleJobsRequest which_jobs;
  int64_t limit = Client::kAllJobs;
  std::optional<int64_t> point;  // absent: all points
  std::string save;

  std::string server;
  ChannelSecurity security;
  std::string data_dir, access_file, credential, file;
  std::vector<std::string> server_flags;  // for ballpistond

  std::string out;
  int64_t port = 0;  // of the page; 0: any

  Format format = Format::kTable;
  ProgressStyle progress = ProgressStyle::kAuto;
  Verbosity verbosity = Verbosity::kNormal;
  bool progress_beats_quiet = false;  // --progress is from a stronger source than --quiet
  std::vector<std::string> words;     // of help, completion and figure
  bool list = false;                  // of figure: print the names
  PageFormat page = PageFormat::kText;
  bool all = false;  // of help: every flag
  Completion completion = Completion::kBash;

  std::vector<std::string> line;  // the words of the command line, the verb included
  std::set<std::string> given;    // names of the flags on the command line: --rho
  std::string connection;         // flags that choose the server: " --server ..."
};

}  // namespace ballpiston::client
