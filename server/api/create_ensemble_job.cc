#include "server/api/methods.h"
#include "server/api/request_check.h"
#include "server/convert/spec.h"

namespace ballpiston::server {
namespace {

absl::Status Check(const CheckedSpec& spec, const RequestCheck& check) {
  if (spec.violations.empty()) return check.status();
  std::vector<FieldViolation> all = spec.violations;
  all.insert(all.end(), check.violations().begin(), check.violations().end());
  return InvalidSpec(all);
}

}  // namespace

absl::StatusOr<v1::EnsembleJob> CreateEnsembleJob(ServiceContext& service,
                                                  const v1::CreateEnsembleJobRequest& request) {
  if (service.draining) return ShuttingDown();
  RequestCheck check;
  const std::string request_id = check.RequestId(request.request_id());
  const CheckedSpec spec = CheckSpec(request.spec());
  const absl::Status checked = Check(spec, check);
  if (!checked.ok()) return checked;
  if (request.validate_only()) return service.book.Preview(request.spec(), spec);
  return service.book.Create(request.spec(), spec, request_id);
}

}  // namespace ballpiston::server
