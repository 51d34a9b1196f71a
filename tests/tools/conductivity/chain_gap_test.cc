#include "tools/conductivity/chain_gap.h"

#include "core/markov/relaxation_spectrum.h"
#include "tests/core/preamble.h"
#include "tests/support/nightly.h"
#include "tools/conductivity/contact_matrix.h"

namespace ballpiston {
namespace {

// Two methods for the same operator: the generator uses piecewise polynomials of the piston's
// speed.
TEST(ChainGap, GapOfThePairMatchesItsGenerator) {
  const double exact = RelaxationSpectrum::Get().Gap().value;
  for (const std::vector<int>& pair : {std::vector<int>{2, 1}, {1, 2}}) {
    EXPECT_NEAR(ChainGap(pair, {10, 12, 14, 16}).gap.value, exact, 5e-11);
    const Eigen::VectorXd bounds = ChainRates(pair, 16);
    EXPECT_GT(bounds[0], exact);
    EXPECT_NEAR(bounds[1], 0.1771867982882, 1e-7);
    EXPECT_NEAR(bounds[2], 0.1892311255467, 3e-7);
  }
}

void HasTheDocumentedGap(const std::vector<int>& chain, std::vector<int> degrees,
                         BoundedValue documented) {
  if (!IsNightly()) degrees.pop_back();
  const BoundedValue gap = ChainGap(chain, degrees).gap;
  EXPECT_NEAR(gap.value, documented.value, (IsNightly() ? 2 : 10) * gap.error + documented.error);
  EXPECT_LT(gap.error, (IsNightly() ? 2e-6 : 5e-5) * gap.value);
}

// The values of docs/research/conductivity.md, by day from fewer degrees. The stated error is the
// change by the last term, which can be half of the true error.
TEST(ChainGap, ChainsHaveTheirDocumentedGaps) {
  HasTheDocumentedGap({2, 1, 2}, {12, 14, 16, 18, 20}, {0.113388479, 2e-9});
  HasTheDocumentedGap({1, 2, 1}, {12, 14, 16, 18, 20}, {0.146330848, 1e-9});
  HasTheDocumentedGap({2, 1, 2, 1}, {8, 10, 12, 14}, {0.10916656, 3e-8});
  HasTheDocumentedGap({2, 1, 2, 1, 2}, {6, 8, 10}, {0.0824165, 1e-7});
  HasTheDocumentedGap({1, 2, 1, 2, 1}, {6, 8, 10}, {0.1018311, 2e-7});
  HasTheDocumentedGap({2, 1, 2, 1, 2, 1}, {4, 6, 8}, {0.067823, 1e-6});
}

// ---- contact_matrix.h ----

// The elements of low degrees do not depend on the largest degree.
TEST(ContactMatrix, HighDegreesAreExactToRounding) {
  const auto differ = [](SiteDimensions d, int low_degree, int high_degree) {
    const Eigen::MatrixXd low = ContactMatrix(d, low_degree);
    const Eigen::MatrixXd high =
        ContactMatrix(d, high_degree).topLeftCorner(low.rows(), low.cols());
    const Eigen::VectorXd scale = low.diagonal().cwiseMax(1e-3).cwiseSqrt();
    return ((high - low).array() / (scale * scale.transpose()).array()).abs().maxCoeff();
  };
  EXPECT_LE(differ({2, 1}, 12, 20), kContactMatrixError);
  EXPECT_LE(differ({2, 2}, 8, 12), kContactMatrixError);
}

}  // namespace
}  // namespace ballpiston
