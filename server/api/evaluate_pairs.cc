#include "server/api/methods.h"
#include "server/convert/analytic.h"

namespace ballpiston::server {

absl::StatusOr<v1::EvaluatePairsResponse> EvaluatePairs(ServiceContext&, const Call&,
                                                        const v1::EvaluatePairsRequest& request) {
  return EvaluatePairs(request);
}

}  // namespace ballpiston::server
