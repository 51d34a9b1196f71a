#include "client/command/verb_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/algorithm/container.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/command/number_list.h"

namespace ballpiston::client {
namespace {

using Spec = v1::EnsembleSpec;

constexpr char kListForm[] = "LIST: a,b,c or from:to:count or from:to:count:log, or a mixture";

// ---- where values go ----

// A token and a token file replace each other.
Store<std::string> Identity(std::string ChannelSecurity::*member) {
  return [member](Options& options, std::string text) {
    options.security.token = options.security.token_file = "";
    options.security.*member = std::move(text);
  };
}

// Appends numbers to a list in a message of the options, as in Grid(&v1::Grid::mutable_rho).
using Numbers = google::protobuf::RepeatedField<double>;

Value Grid(Numbers* (v1::Grid::*list)()) {
  return Parsed("LIST", ParseNumberList,
                [list](Options& options, const std::vector<double>& numbers) {
                  (options.spec.mutable_grid()->*list)()->Add(numbers.begin(), numbers.end());
                });
}

Value GridCells() {
  return Parsed("LIST", ParseShapeList,
                [](Options& options, const std::vector<std::string>& shapes) {
                  options.spec.mutable_grid()->mutable_cells()->Add(shapes.begin(), shapes.end());
                });
}

Value Asked(Numbers* (v1::EvaluatePairsRequest::*list)()) {
  return Parsed("LIST", ParseNumberList,
                [list](Options& options, const std::vector<double>& numbers) {
                  (options.closed_forms.*list)()->Add(numbers.begin(), numbers.end());
                });
}

v1::Target& Target(Options& options) { return *options.spec.mutable_target(); }

// The seconds and the nanoseconds of a duration have the sign of the number. A duration can hold
// 10,000 years; the server's limit is smaller.
void SetBudget(Options& options, double seconds) {
  constexpr double kMost = 315576000000;
  seconds = std::clamp(seconds, -kMost, kMost);
  google::protobuf::Duration& budget = *Target(options).mutable_budget();
  constexpr int32_t kNanos = 1'000'000'000;
  const auto nanos = static_cast<int32_t>(std::lround((seconds - std::trunc(seconds)) * kNanos));
  budget.set_seconds(static_cast<int64_t>(seconds) + nanos / kNanos);
  budget.set_nanos(nanos % kNanos);
}

// The table has --progress before --quiet. If --quiet is already set, its source is a weaker one.
void SetProgress(Options& options, ProgressStyle style) {
  options.progress = style;
  options.progress_beats_quiet = options.verbosity == Verbosity::kQuiet;
}

Value VerbositySwitch(Verbosity verbosity) {
  return Switch([verbosity](Options& options, bool on) {
    if (!on) return;
    options.verbosity = verbosity;
    options.progress_beats_quiet = false;
  });
}

// A switch that the verb passes on.
Value Forwarded(const std::string& flag) {
  return Switch([flag](Options& options, bool on) {
    if (on) options.words.push_back(flag);
  });
}

Flag Required(std::string name, Value value, std::string text) {
  return {std::move(name), std::move(value), std::move(text), /*variable=*/"",
          /*is_required=*/true};
}

Flag Rare(Flag flag) {
  flag.is_everyday = false;
  return flag;
}

// ---- flags ----

const FlagGroup kCommon = {
    "General flags",
    {{"-q,--quiet", VerbositySwitch(Verbosity::kQuiet),
      "print no progress and no notes, only errors", "BALLPISTON_QUIET"},
     {"-v,--verbose", VerbositySwitch(Verbosity::kVerbose),
      "print which server, request ids and programs are used", "BALLPISTON_VERBOSE"},
     {"--config", File([](Options&, const std::string&) {}),
      "config file to read instead of ~/.config/ballpiston/config.toml", "BALLPISTON_CONFIG"}},
    /*is_everyday=*/false};

const FlagGroup kServer = {
    "Server",
    {{"--server", Text("ADDRESS", To(&Options::server)),
      "host:port or unix:PATH; by default the private server, which the client starts when needed",
      "BALLPISTON_SERVER"},
     {"--ca", File([](Options& o, std::string ca) { o.security.ca = std::move(ca); }),
      "TLS: PEM file of the authority that signed the server's certificate", "BALLPISTON_CA"},
     {"--tls", Switch([](Options& options, bool tls) { options.security.tls = tls; }),
      "TLS: trust the certificate authorities of this system", "BALLPISTON_TLS"},
     {"", Text("TOKEN", Identity(&ChannelSecurity::token)),
      "your token; there is no flag for it, because all users of a machine can see command lines",
      "BALLPISTON_TOKEN"},
     {"--token-file", File(Identity(&ChannelSecurity::token_file)),
      "file with your token, for TLS or a loopback address; other users must not be able to read "
      "it",
      "BALLPISTON_TOKEN_FILE"}},
    /*is_everyday=*/false};

const FlagGroup kGrid = {
    absl::StrCat("Grid (", kListForm, ")"),
    {{"--rho", Grid(&v1::Grid::mutable_rho), "disc radii, 1/2 < rho < 1/sqrt(2)"},
     {"--delta", Grid(&v1::Grid::mutable_delta),
      "the piston's penetrations, 0 < delta <= (1 - lambda)/2"},
     {"--epsilon", Grid(&v1::Grid::mutable_epsilon),
      "the piston's energies, 0 to 1/2; optional in energy-relaxation"},
     {"--exponent", Grid(&v1::Grid::mutable_exponent), "n of the outgoing law h^(n)"},
     {"--cells", GridCells(),
      "shapes of the gas: N or NxM; a chain of N cells, or a lattice of N columns and M rows"},
     {"--temperature", Grid(&v1::Grid::mutable_temperature),
      "temperatures of a gas in equilibrium; by default 1 (the Boltzmann constant is 1)"},
     {"--hot", Grid(&v1::Grid::mutable_hot), "temperatures of the hot reservoir"},
     {"--cold", Grid(&v1::Grid::mutable_cold), "temperatures of the cold reservoir"},
     Rare({"--points", File(To(&Options::points_file)),
           "CSV file with a table of points; its header names the parameters, in any order; the "
           "flags of other parameters multiply the table; - is standard input"})}};

const FlagGroup kTarget = {
    "Target (at most one; --tolerance and --budget can be combined)",
    {{"--samples", Parsed("N", ParseCount, [](Options& o, int64_t n) { Target(o).set_samples(n); }),
      "samples per point"},
     {"--collisions",
      Parsed("N", ParseCount, [](Options& o, int64_t n) { Target(o).set_collisions(n); }),
      "ball-piston collisions per point"},
     {"--tolerance",
      Parsed("REL", ParseNumber, [](Options& o, double x) { Target(o).set_tolerance(x); }),
      "relative standard error of the first estimate; a point is finished when it reaches this "
      "error"},
     {"--budget", Parsed("SECONDS", ParseNumber, &SetBudget),
      "time of all workers, divided evenly between the points; with --tolerance, the job fails if "
      "this time is too short"}}};

const FlagGroup kMethod = {
    "Method",
    {{"--seed", Parsed("SEED", ParseSeed, [](Options& o, uint64_t seed) { o.spec.set_seed(seed); }),
      "seed of the random numbers, by default 0"},
     {"--model",
      OneOf<Spec::Model>("MODEL", [](Options& o, Spec::Model model) { o.spec.set_model(model); }),
      "model, by default auto; auto is the cheapest model that gives the estimate"},
     Rare({"--estimate",
           Text("NAME",
                [](Options& o, std::string name) { Target(o).set_estimate(std::move(name)); }),
           "the estimate of --tolerance and --model auto, one of the names in docs/answers.md; the "
           "result prints it first; the error of a wrong name lists those that the experiment "
           "permits"}),
     Rare({"--precision",
           OneOf<Spec::Precision>("PRECISION",
                                  [](Options& o, Spec::Precision x) { o.spec.set_precision(x); }),
           "floating-point precision of the billiard; by default double"}),
     {"--verify", Switch([](Options& o, bool verify) { o.spec.set_verify(verify); }),
      "also simulate points that have a closed form; with --model auto; the exact values stand "
      "beside the simulated values"},
     Rare({"--spec", File(To(&Options::spec_file)),
           "JSON file with the whole specification; - is standard input; it replaces EXPERIMENT "
           "and all flags of grid, target and method"}),
     Rare({"--again", Job(To(&Options::again)),
           "use the specification of this job, and its labels unless --label is given; it replaces "
           "EXPERIMENT and all flags of grid, target and method"})}};

const FlagGroup kJob = {
    "Job",
    {{"--fresh", Switch([](Options& o, bool fresh) { o.create.set_fresh(fresh); }),
      "compute the results even if the server has stored results for the same specification"},
     {"--resume", Switch(To(&Options::resume)),
      "derive the request id from the specification: after an interruption, the same command "
      "returns the original job, unless that job failed or was cancelled, or its results have "
      "expired"},
     {"--request-id",
      Text("UUID", [](Options& o, std::string id) { o.create.set_request_id(std::move(id)); }),
      "idempotency key: a retry with the same UUID returns the original job"},
     {"--priority",
      CountFrom(-100, 100,
                [](Options& o, int64_t n) { o.create.set_priority(static_cast<int32_t>(n)); }),
      "by default 0; the server runs your jobs with a higher priority first"},
     {"--label", Labels("KEY=VALUE"),
      "a label of the job, by which it can be found again; may be repeated"}},
    /*is_everyday=*/false};

const FlagGroup kFormat = {"Output",
                           {{"--format", OneOf("FORMAT", To(&Options::format), kFormats),
                             "format on standard output; by default table"}}};

const FlagGroup kFormatAndSave = {
    kFormat.title,
    {kFormat.flags[0],
     {"--save", File(To(&Options::save)),
      "write the result to this file: .json, .csv or .npz; it has the specification, the seed and "
      "the versions; prints the file's path. .json has everything, .npz NumPy arrays (this needs "
      "the Python package), .csv the estimates"}}};

const FlagGroup kProgress = {
    "Progress",
    {{"--progress", OneOf<ProgressStyle>("STYLE", &SetProgress, kProgressStyles),
      "progress on standard error; by default auto, which shows a bar if standard error is a "
      "terminal, else nothing",
      "BALLPISTON_PROGRESS"}},
    /*is_everyday=*/false};

const FlagGroup kClosedForms = {
    kListForm,
    {{"--rho", Asked(&v1::EvaluatePairsRequest::mutable_rho), "disc radii, 1/2 < rho < 1/sqrt(2)"},
     {"--delta", Asked(&v1::EvaluatePairsRequest::mutable_delta),
      "the piston's penetrations, 0 < delta <= (1 - lambda)/2"},
     {"--epsilon", Asked(&v1::EvaluatePairsRequest::mutable_epsilon),
      "the piston's energies, 0 to 1/2: conditional rates, and moments of the kernel"},
     {"--outgoing-epsilon", Asked(&v1::EvaluatePairsRequest::mutable_outgoing_epsilon),
      "outgoing energies: the kernel W"},
     {"--temperature", Asked(&v1::EvaluatePairsRequest::mutable_temperature),
      "temperatures: canonical averages, exchange rate, static conductivity"},
     {"--beta", Asked(&v1::EvaluatePairsRequest::mutable_beta),
      "inverse temperatures: the same quantities"}}};

const FlagGroup kTrace = {
    "Orbit",
    {Required("--rho", Parsed("X", ParseNumber, [](Options& o, double x) { o.trace.set_rho(x); }),
              "disc radius, 1/2 < rho < 1/sqrt(2)"),
     Required("--delta",
              Parsed("X", ParseNumber, [](Options& o, double x) { o.trace.set_delta(x); }),
              "the pistons' penetration, above 0, up to (1 - lambda)/2 for a pair and rho/sqrt(2) "
              "- lambda/2 for a gas"),
     {"--cells",
      Text("SHAPE",
           [](Options& o, const std::string& cells) { o.trace.set_cells(ShapeText(cells)); }),
      "a periodic gas of this shape instead of a pair: N, a chain of N cells, or NxM, a lattice of "
      "N columns and M rows; at most 1,000 cells"},
     {"--temperature",
      Parsed("X", ParseNumber, [](Options& o, double x) { o.trace.set_temperature(x); }),
      "temperature of the gas, by default 1; a pair has the energy 1/2"},
     {"--seed",
      Parsed("SEED", ParseSeed, [](Options& o, uint64_t seed) { o.trace.set_seed(seed); }),
      "seed of the random start, by default 0"},
     Required("--events",
              Parsed("N", ParseCount, [](Options& o, int64_t n) { o.trace.set_events(n); }),
              "number of events, 1 to 1,000,000")}};

const FlagGroup kListFilter = {
    "Which jobs",
    {{"--state",
      SomeOf<v1::EnsembleJob::State>(
          "STATES", [](Options& o, v1::EnsembleJob::State x) { o.which_jobs.add_states(x); }),
      "only jobs in one of these states"},
     {"--experiment",
      SomeOf<Spec::Experiment>(
          "EXPERIMENTS", [](Options& o, Spec::Experiment x) { o.which_jobs.add_experiments(x); }),
      "only jobs with one of these experiments"},
     {"--since",
      Parsed("DATE", ParseDate,
             [](Options& o, const google::protobuf::Timestamp& time) {
               *o.which_jobs.mutable_since() = time;
             }),
      "only jobs submitted at this time (UTC) or later"},
     {"--label", Labels("KEY=VALUE"), "only jobs with this label; may be repeated"},
     {"--limit", CountFrom(1, Client::kAllJobs, To(&Options::limit)),
      "largest number of jobs to list, by default all"}}};

const FlagGroup kSelection = {
    "Which jobs",
    {{"--label", Labels("KEY=VALUE"),
      "instead of names: all jobs with this label; may be repeated, for jobs with all of them"}}};

const FlagGroup kConfirmed = {
    kSelection.title,
    {kSelection.flags[0],
     {"--yes", Switch(To(&Options::yes)), "act on all of them; by default the program asks"}}};

const FlagGroup kPoint = {
    "Which points",
    {{"--point", CountFrom(0, INT64_MAX, [](Options& o, int64_t index) { o.point = index; }),
      "only the point with this position in the grid, from 0; by default all finished points"}}};

const FlagGroup kWatch = {
    "Watch",
    {{"--exec", Text("COMMAND", To(&Options::command)),
      "run this command of the shell when a job ends; its environment has "
      "BALLPISTON_JOB and BALLPISTON_JOB_STATE"},
     {"--any", Switch(To(&Options::any)),
      "return when one of the jobs has ended; the others go on. With --label, only jobs "
      "that are active now count"}}};

const FlagGroup kPin = {
    "Pin", {{"--undo", Switch(To(&Options::undo)), "unpin: the results may expire again"}}};

const FlagGroup kFigure = {
    "Figure",
    {{"--out",
      Text(
          "DIR", [](Options& o, const std::string& dir) { o.words.push_back("--out=" + dir); },
          Offer::kFile),
      "folder for data and pictures; required"},
     {"--list", Switch(To(&Options::list)), "print the names of the figures; draw nothing"},
     {"--quick", Forwarded("--quick"),
      "few samples: the figure takes seconds, at most two minutes"},
     {"--full", Forwarded("--full"), "at least the paper's number of samples: minutes to hours"},
     {"--edit", Forwarded("--edit"),
      "only copy the figure's Python module to DIR, so that you can edit it; a module that is "
      "already there is used unchanged"}}};

const FlagGroup kReport = {"Report",
                           {Required("--out", File(To(&Options::out)), "the HTML file to write")}};

const FlagGroup kTableFile = {
    "File",
    {Required("--out", File(To(&Options::out)), "the file to write, .csv, .npz or .parquet")}};

const FlagGroup kWeb = {"Page",
                        {{"--port", CountFrom(0, 65535, To(&Options::port)),
                          "port for local connections, by default a free one"}}};

const FlagGroup kDataFolder = {
    "Which server",
    {{"--data-dir", File(To(&Options::data_dir)),
      "the data folder of a server on this machine; by default the private server's folder"},
     {"", Text("ADDRESS", To(&Options::server)),
      "if this variable or server in the config file is set, give --data-dir: your commands then "
      "do not use the private server",
      "BALLPISTON_SERVER"}}};

const FlagGroup kStart = {"Settings",
                          {{"--listen", Passed("ADDRESS", "--listen"),
                            "unix:PATH or host:port; by default a socket in the data folder"},
                           {"--workers", Passed("N", "--workers"),
                            "number of threads that compute; by default one for each core that the "
                            "affinity and the control group (cgroup) permit"}}};

const FlagGroup kToken = {
    "Access",
    {Required("--access-file", File(To(&Options::access_file)), "the server's access file")}};

const FlagGroup kPage = {
    "Page",
    {{"--all", Switch(To(&Options::all)), "describe every flag of the verb"},
     {"--format",
      OneOf("FORMAT", To(&Options::page),
            {{"text", PageFormat::kText},
             {"man", PageFormat::kMan},
             {"markdown", PageFormat::kMarkdown}}),
      "format of the page, by default text; markdown prints all pages"},
     {"--out", File(To(&Options::out)), "folder to write the man pages of all verbs to"}}};

// ---- arguments ----

const Store<std::string> kWords = [](Options& options, std::string word) {
  options.words.push_back(std::move(word));
};

// A job that is named twice counts once.
const Store<std::string> kJobs = [](Options& options, std::string name) {
  if (absl::c_linear_search(options.jobs, name)) return;
  options.jobs.push_back(std::move(name));
};

// Optional, because --spec or --again can replace it.
const Argument kExperiment = {
    OneOf<Spec::Experiment>("EXPERIMENT",
                            [](Options& o, Spec::Experiment x) { o.spec.set_experiment(x); }),
    "the experiment to run", Argument::kOptional};
const Argument kOneJob = {Job(kJobs), "ensembleJobs/ID, or the ID alone"};
const Argument kSomeJobs = {Job(kJobs), "ensembleJobs/ID, or the ID alone", Argument::kSeveral};
const Argument kJobsOrLabels = {Job(kJobs), "ensembleJobs/ID, or the ID alone", Argument::kAny};

// ---- verbs ----

const std::vector<const FlagGroup*> kQuestion = {&kGrid, &kTarget, &kMethod};

std::vector<const FlagGroup*> With(std::vector<const FlagGroup*> groups,
                                   std::vector<const FlagGroup*> more = {}) {
  groups.insert(groups.end(), more.begin(), more.end());
  groups.push_back(&kCommon);
  return groups;
}

Verb StatusVerb(const std::string& name, const std::string& summary) {
  return {name,
          summary,
          "Starts no server.",
          {},
          With({&kFormat, &kServer}),
          {"server status",
           "server status --server lab.example.org:50051 --ca authority.pem --token-file ada.token "
           "--format json"},
          &ServerStatus};
}

std::vector<Verb> AllVerbs() {
  return {
      {"analytic",
       "evaluate the closed forms",
       "Prints one set of values for every pair of rho and delta.",
       {},
       With({&kClosedForms, &kFormat, &kServer}),
       {"analytic --rho 0.5296 --delta 0.2 --epsilon 0.1,0.2",
        "analytic --rho 0.5296 --delta 0.1:0.3:5 --temperature 1:2:3 --format csv"},
       &Analytic},
      {"plan",
       "show the cost and the accuracy of each model",
       "Runs nothing.",
       {kExperiment},
       With(kQuestion, {&kFormat, &kServer}),
       {"plan energy-relaxation --rho 0.5296 --delta 0.2,0.0125 --tolerance 0.01",
        "plan first-hit --rho 0.5296 --delta 0.1 --epsilon 0.125 --exponent 1 --samples 1e6 "
        "--format csv"},
       &Plan},
      {"run",
       "submit a job, watch it, print its result",
       "Ctrl-C ends the client, but not the job; the message says how to watch the job again. If "
       "the server has stored results for the same specification, it returns them.",
       {kExperiment},
       With(kQuestion, {&kJob, &kFormatAndSave, &kProgress, &kServer}),
       {"run conditional-mean-free-time --rho 0.5296 --delta 0.1,0.2 --epsilon 0.1:0.4:4 --verify",
        "run first-hit --rho 0.5296 --delta 0.1 --epsilon 0.125 --exponent 1,2 --samples 1e5 "
        "--format csv"},
       &Run},
      {"submit",
       "submit a job, print its name",
       "Standard output contains only the name. When it is printed, the job is on the server's "
       "disk.",
       {kExperiment},
       With(kQuestion, {&kJob, &kServer}),
       {"submit equilibrium --rho 0.51:0.7:20 --delta 0.01 --model billiard --collisions 1e6",
        "submit --again ID --priority 10"},
       &Submit},
      {"watch",
       "show a job's progress until it ends",
       "Ctrl-C ends the client, but not the jobs. Of several jobs it prints each name and state "
       "when the job ends.",
       {kJobsOrLabels},
       With({&kWatch, &kSelection, &kProgress, &kServer}),
       {"watch ensembleJobs/ID", "watch ID --progress json 2>progress.jsonl",
        "watch --label run=7 --any --exec ./next.sh"},
       &Watch},
      {"result",
       "print a job's result: the points that it has finished so far",
       "",
       {kJobsOrLabels},
       With({&kSelection, &kPoint, &kFormatAndSave, &kServer}),
       {"result ensembleJobs/ID", "result ID --save result.json",
        "result ID --point 17 --format json >point.json"},
       &Result},
      {"list",
       "list the jobs, the newest first",
       "The column 'results' shows which jobs are pinned, and which results have expired or will "
       "expire within a week.",
       {},
       With({&kListFilter, &kFormat, &kServer}),
       {"list --state running,queued", "list --experiment first-hit --since 2026-01-31 --limit 10"},
       &ListJobs},
      {"cancel",
       "stop jobs; the points that they finished stay",
       "Prints each job's name and state.",
       {kJobsOrLabels},
       With({&kConfirmed, &kServer}),
       {"cancel ensembleJobs/ID", "cancel ID1 ID2", "cancel --label run=7 --yes"},
       &Cancel},
      {"pin",
       "keep the results of jobs: they do not expire",
       "Prints each job's name, and whether it is pinned now.",
       {kSomeJobs},
       With({&kPin, &kServer}),
       {"pin ensembleJobs/ID", "pin --undo ID1 ID2"},
       &Pin},
      {"label",
       "set and remove labels of a job",
       "KEY=VALUE sets a label, KEY= removes it. Prints the job's name and its labels. list, "
       "watch, result, export, report, cancel and delete find jobs by --label.",
       {kOneJob,
        {Labels("KEY=VALUE"),
         "a key of a-z, 0-9 and _ . - that begins with a letter, and a value of letters, digits "
         "and _ . : / @ + -, each of at most 63 characters",
         Argument::kSeveral}},
       With({&kServer}),
       {"label ensembleJobs/ID run=7 who=pilot", "label ID who="},
       &Label},
      {"delete",
       "delete ended jobs and their results",
       "Prints the name of each job that it deleted. With --label, pinned jobs are not deleted.",
       {kJobsOrLabels},
       With({&kConfirmed, &kServer}),
       {"delete ensembleJobs/ID", "delete ID1 ID2", "delete --label who=pilot"},
       &Delete},
      {"trace",
       "print one orbit, event by event, as JSON lines",
       "The first line is the start: the geometry, and the positions and velocities of all bodies. "
       "Every other line is an event (ball_piston, ball_wall or piston_wall): its time, the time "
       "since the last event of the same kind with the same bodies (free_time), and the position, "
       "velocity and energies of each body that takes part. The same command always prints the "
       "same lines. proto/ballpiston/v1/trace.proto describes the fields.",
       {},
       With({&kTrace, &kServer}),
       {"trace --rho 0.5296 --delta 0.2 --events 1000 >orbit.jsonl",
        "trace --rho 0.5296 --delta 0.1 --cells 4x3 --events 1000 | jq -r 'select(.event == "
        "\"ball_piston\") | [.time, .ball, .ball_energy] | @tsv'"},
       &Trace},
      {"sample",
       "write the collisions of a point's samples to a file",
       "A row for each ball-piston collision: sample, times, place, velocities before and after, "
       "energies. They are the collisions that `run --verify` with the same flags averages. One "
       "point, of an experiment with a pair except lyapunov, by a billiard, with samples or "
       "collisions. .npz and .parquet need Python with the package ballpiston, and memory for all "
       "rows, some 200 bytes each. Prints the path of the file. proto/ballpiston/v1/trace.proto "
       "describes the columns.",
       {kExperiment},
       With(kQuestion, {&kTableFile, &kServer}),
       {"sample first-hit --rho 0.5296 --delta 0.2 --epsilon 0.125 --exponent 1 --samples 1e5 "
        "--out hits.npz",
        "sample equilibrium --rho 0.5296 --delta 0.2 --collisions 1e4 --out collisions.csv"},
       &Sample},
      {"figure",
       "draw a figure: data, SVG and PNG",
       "A figure also has its own flags, such as --rho and --samples: figure NAME --help shows "
       "them. The config file cannot set them. After an interruption, the same command resumes the "
       "jobs of the figure. Figures need Python with the package ballpiston and matplotlib: "
       "python3-ballpiston, python3-matplotlib.",
       {{Text(
             "NAME", [](Options&, const std::string&) {}, Offer::kFigure),
         "one of the names that --list prints", Argument::kOptional}},
       With({&kFigure, &kProgress, &kServer}),
       {"figure mean-free-time --out figures", "figure relaxation --quick --delta 0.2,0.1 --out x",
        "figure --list"},
       &Figure,
       /*passes_words_on=*/true},
      {"export",
       "write the estimates of many jobs to one file",
       "A row for each estimate of each point, with the job, its principal, labels, seed, "
       "precision, engine version and parameters. Without JOB and --label: of all jobs, for an "
       "administrator also those of other users. A job whose column 'continues' names another one "
       "contains its samples: do not average the two. Needs Python with the package ballpiston, "
       "and for .parquet pandas and pyarrow. Prints the path of the file.",
       {{Job(kJobs), "ensembleJobs/ID, or the ID alone", Argument::kAny}},
       With({&kTableFile, &kSelection, &kServer}),
       {"export --label run=7 --out run7.csv", "export ID1 ID2 --out two.parquet"},
       &Export},
      {"report",
       "write one HTML file with the pictures, tables and specifications of jobs",
       "The file needs neither a server nor a network. It contains the first 12 points of each job "
       "in full, and the estimates of up to 10,000 points. Prints the path of the file.",
       {kJobsOrLabels},
       With({&kReport, &kSelection, &kServer}),
       {"report ensembleJobs/ID --out report.html", "report ID1 ID2 --out sweep.html"},
       &ReportJobs},
      {"web",
       "show jobs and results in a browser, and forward JSON calls to the server",
       "Prints the address of the page, with an access token, and serves the page on this machine "
       "until Ctrl-C. The same address answers calls of the API as JSON in the Connect protocol, "
       "for curl and notebooks: client/README.md has examples.",
       {},
       With({&kWeb, &kServer}),
       {"web", "web --port 8080 --server lab.example.org:50051 --ca authority.pem"},
       &Web},
      {"server start",
       "start a server on this machine, print its address",
       "The server runs until it is stopped. If a server already runs in the data folder, the "
       "command prints the address of that server, which may stop when it is idle; with --listen, "
       "--workers or words after -- it fails, because they would have no effect. Words after -- "
       "are flags for ballpistond.",
       {{Words("FLAG",
               [](Options& o, std::string flag) { o.server_flags.push_back(std::move(flag)); }),
         "flags for ballpistond, after --", Argument::kRest}},
       With({&kDataFolder, &kStart}),
       {"server start",
        "server start --data-dir data --listen 127.0.0.1:50051 --workers 8 -- --metrics-listen "
        "127.0.0.1:9464"},
       &ServerStart},
      {"server stop",
       "stop a server on this machine",
       "Returns when the server has ended. The server resumes its jobs when it is started again.",
       {},
       With({&kDataFolder}),
       {"server stop", "server stop --data-dir data"},
       &ServerStop},
      {"server address",
       "print the address of the server that commands use",
       "Starts the private server if the address is its address and it does not run. Programs in "
       "other languages can connect there.",
       {},
       With({&kServer}),
       {"server address", "server address --server lab.example.org:50051 --ca authority.pem"},
       &ServerAddress},
      StatusVerb("server status", "show the server's load and its limits"),
      {"server token",
       "make a token, append its hash to an access file, print the token",
       "ROLE is read, submit or admin. The token is printed once; keep it in a file that other "
       "users cannot read.",
       {{Text("PRINCIPAL:ROLE[:DAYS]", To(&Options::credential)),
         "the user, the role, and the days until the token expires"}},
       With({&kToken}),
       {"server token ada:submit --access-file access | (umask 077; cat >ada.token)",
        "server token backup:read:365 --access-file access | (umask 077; cat >backup.token)"},
       &ServerToken},
      {"server backup",
       "copy a server's store to a file, and check the copy",
       "The server can be running.",
       {{File(To(&Options::file)), "the file to write; it must not exist"}},
       With({&kDataFolder}),
       {"server backup store-2026-01-31.sqlite3", "server backup copy.sqlite3 --data-dir data"},
       &ServerBackup},
      {"server check",
       "check the whole store of a server",
       "The server can be running. The exit code is 0 if the store is sound.",
       {},
       With({&kDataFolder}),
       {"server check", "server check --data-dir data"},
       &ServerCheck},
      StatusVerb("status", "the same as server status"),
      {"help",
       "print the help of the program or of a verb",
       "",
       {{Words("VERB", kWords), "words of the verb, such as: server start", Argument::kAny}},
       With({&kPage}),
       {"help run", "help --all run", "help --format man --out man1"},
       &Help},
      {"completion",
       "print a script that completes command lines in a shell",
       "The script also completes names of jobs if a server is running.",
       {{OneOf("SHELL", To(&Options::completion),
               {{"bash", Completion::kBash},
                {"zsh", Completion::kZsh},
                {"fish", Completion::kFish},
                {"words", Completion::kWords}}),
         "the shell; only the scripts use 'words'"},
        {Words("WORD", kWords), "after --: the words so far; the last word is completed",
         Argument::kRest}},
       With({&kServer}),
       {"completion bash >~/.local/share/bash-completion/completions/ballpiston",
        "completion fish >~/.config/fish/completions/ballpiston.fish"},
       &Complete}};
}

}  // namespace

const std::vector<Verb>& Verbs() {
  static const auto* const verbs = new std::vector<Verb>(AllVerbs());
  return *verbs;
}

int WordsIn(const std::string& verb_name) {
  return 1 + static_cast<int>(std::count(verb_name.begin(), verb_name.end(), ' '));
}

const Verb* VerbAt(const std::vector<std::string>& words) {
  for (const Verb& verb : Verbs()) {
    const std::vector<std::string> names = absl::StrSplit(verb.name, ' ');
    const bool is_long_enough = words.size() >= names.size();
    if (is_long_enough && std::equal(names.begin(), names.end(), words.begin())) return &verb;
  }
  return nullptr;
}

std::vector<std::string> NextWords(const std::string& begin) {
  std::vector<std::string> words;
  for (const Verb& verb : Verbs()) {
    absl::string_view rest = verb.name;
    if (!absl::ConsumePrefix(&rest, begin)) continue;
    const std::string word(rest.substr(0, rest.find(' ')));
    if (words.empty() || words.back() != word) words.push_back(word);
  }
  return words;
}

const FlagGroup& ServerFlags() { return kServer; }
const FlagGroup& TargetFlags() { return kTarget; }
const std::vector<const FlagGroup*>& QuestionFlags() { return kQuestion; }

const std::vector<Remark> kExitCodes = {
    {"0", "success"},
    {"2",
     "wrong usage or an invalid argument, a job too large for the server, or output that cannot "
     "be written"},
    {"3", "no server answers, or the server is busy: retry later"},
    {"4", "the job failed or was cancelled, or its state does not permit the call"},
    {"5", "no such job, or no result of that point"},
    {"6", "not authenticated or not authorised"},
    {"130", "interrupted"}};

const std::vector<Remark> kFiles = {
    {"~/.config/ballpiston/config.toml",
     "values for flags that are not given. A line such as format = \"csv\" applies to every verb "
     "that has the flag; below [run] it applies only to run. Environment variables override the "
     "file, and flags override both; an empty variable counts as not set. XDG_CONFIG_HOME "
     "replaces ~/.config"},
    {"~/.local/state/ballpiston",
     "jobs, log and socket of the private server. XDG_STATE_HOME replaces ~/.local/state. "
     "BALLPISTON_SERVER_PROGRAM is the ballpistond to start"},
    {"python3",
     "draws figures; /usr/bin/python3 if the one in PATH lacks their packages. BALLPISTON_PYTHON "
     "is another Python to start"}};

bool IsOf(const FlagGroup& group, const Flag& flag) {
  return std::any_of(group.flags.begin(), group.flags.end(),
                     [&flag](const Flag& other) { return &other == &flag; });
}

std::vector<const Flag*> FlagsOf(const Verb& verb) {
  std::vector<const Flag*> flags;
  for (const FlagGroup* group : verb.groups) {
    for (const Flag& flag : group->flags) flags.push_back(&flag);
  }
  return flags;
}

std::string LongName(const Flag& flag) {
  return flag.name.empty() ? "" : flag.name.substr(flag.name.find("--"));
}

std::string KeyOf(const Flag& flag) {
  if (!flag.name.empty()) return LongName(flag).substr(2);
  const absl::string_view variable = absl::StripPrefix(flag.variable, "BALLPISTON_");
  return absl::StrReplaceAll(absl::AsciiStrToLower(variable), {{"_", "-"}});
}

}  // namespace ballpiston::client
