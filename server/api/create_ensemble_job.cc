#include "absl/strings/str_cat.h"
#include "server/api/methods.h"
#include "server/api/request_check.h"
#include "server/convert/spec.h"
#include "server/observability/log.h"

namespace ballpiston::server {
namespace {

constexpr int kHighestPriority = 100;

absl::Status Check(const CheckedSpec& spec, const RequestCheck& check) {
  if (spec.violations.empty()) return check.status();
  std::vector<FieldViolation> all = spec.violations;
  all.insert(all.end(), check.violations().begin(), check.violations().end());
  return InvalidSpec(all);
}

void LogAcceptance(const Call& call, const v1::EnsembleJob& job) {
  Log(Severity::kInfo, job.answered_from_store() ? "question answered by a job" : "job accepted",
      {{"method", call.method},
       {"job", job.name()},
       {"principal", call.caller.name},
       {"request_id", call.request_id},
       {"points", job.progress().points()}});
}

}  // namespace

absl::StatusOr<v1::EnsembleJob> CreateEnsembleJob(ServiceContext& service, const Call& call,
                                                  const v1::CreateEnsembleJobRequest& request) {
  if (service.draining) return ShuttingDown();
  RequestCheck check;
  v1::CreateEnsembleJobRequest accepted = request;
  accepted.set_request_id(check.RequestId(request.request_id()));
  if (request.priority() < -kHighestPriority || request.priority() > kHighestPriority) {
    check.Add("priority", absl::StrCat("is ", request.priority(), "; permitted: -",
                                       kHighestPriority, " to ", kHighestPriority));
  }
  AddDefaults(*accepted.mutable_spec());
  CheckedSpec spec = CheckSpec(accepted.spec());
  if (spec.violations.empty()) AddViolations(service.ladder.ViolationsHere(spec.spec), spec);
  const absl::Status checked = Check(spec, check);
  if (!checked.ok()) return checked;
  if (request.validate_only()) return service.book.Preview(call.caller, accepted, spec);
  absl::StatusOr<v1::EnsembleJob> job = service.book.Create(call.caller, accepted, spec);
  if (job.ok()) LogAcceptance(call, *job);
  return job;
}

}  // namespace ballpiston::server
