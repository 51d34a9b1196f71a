#include "absl/strings/str_cat.h"
#include "server/convert/spec.h"
#include "server/rpc/methods.h"
#include "server/rpc/request_check.h"

namespace ballpiston::server {
namespace {

absl::Status Check(const CheckedSpec& spec, const RequestCheck& check) {
  if (spec.violations.empty()) return check.status();
  std::vector<FieldViolation> all = spec.violations;
  all.insert(all.end(), check.violations().begin(), check.violations().end());
  return InvalidSpec(all);
}

void LogAcceptance(const Call& call, const v1::EnsembleJob& job) {
  LogDone(call, job.answered_from_store() ? "question answered by a job" : "job accepted",
          job.name(), absl::StrCat(job.progress().points()));
}

}  // namespace

absl::StatusOr<v1::EnsembleJob> CreateEnsembleJob(ServiceContext& service, const Call& call,
                                                  const v1::CreateEnsembleJobRequest& request) {
  if (service.draining) return ShuttingDown();
  RequestCheck check;
  v1::CreateEnsembleJobRequest accepted = request;
  accepted.set_request_id(check.RequestId(request.request_id()));
  check.Priority("priority", request.priority());
  check.LabelsIn("labels", request.labels());
  AddDefaults(*accepted.mutable_spec());
  CheckedSpec spec = CheckSpec(accepted.spec());
  if (spec.violations.empty()) AddViolations(service.ladder.ViolationsHere(spec.spec), spec);
  const absl::Status checked = Check(spec, check);
  if (!checked.ok()) return checked;
  absl::StatusOr<v1::EnsembleJob> job = service.book.Create(call.caller, accepted, spec);
  if (job.ok()) LogAcceptance(call, *job);
  return job;
}

}  // namespace ballpiston::server
