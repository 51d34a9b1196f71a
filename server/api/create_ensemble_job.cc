#include "absl/strings/str_cat.h"
#include "server/api/methods.h"
#include "server/api/request_check.h"
#include "server/convert/spec.h"

namespace ballpiston::server {
namespace {

constexpr int kHighestPriority = 100;

absl::Status Check(const CheckedSpec& spec, const RequestCheck& check) {
  if (spec.violations.empty()) return check.status();
  std::vector<FieldViolation> all = spec.violations;
  all.insert(all.end(), check.violations().begin(), check.violations().end());
  return InvalidSpec(all);
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
  const CheckedSpec spec = CheckSpec(request.spec());
  const absl::Status checked = Check(spec, check);
  if (!checked.ok()) return checked;
  if (request.validate_only()) return service.book.Preview(call.caller, accepted, spec);
  return service.book.Create(call.caller, accepted, spec);
}

}  // namespace ballpiston::server
