#include "server/jobs/question.h"

#include "absl/strings/str_cat.h"
#include "server/convert/spec.h"
#include "server/sha256.h"

namespace ballpiston::server {

std::string QuestionOf(const v1::EnsembleSpec& spec, const std::string& engine_version) {
  if (spec.target().has_budget()) return std::string();
  return Sha256(absl::StrCat(engine_version, "\n", QuestionBytes(spec)));
}

std::string PayloadOf(const v1::CreateEnsembleJobRequest& request) {
  return Sha256(absl::StrCat(request.fresh() ? "fresh" : "", "\n", request.priority(), "\n",
                             QuestionBytes(request.spec())));
}

}  // namespace ballpiston::server
