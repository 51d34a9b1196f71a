#include "tools/conductivity/contact_matrix.h"

#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// The elements of low degrees do not depend on the largest degree.
TEST(ContactMatrix, HighDegreesAreExactToRounding) {
  const auto differ = [](SiteDimensions d, int low_degree, int high_degree) {
    const Eigen::MatrixXd low = ContactMatrix(d, low_degree).elements();
    const Eigen::MatrixXd high =
        ContactMatrix(d, high_degree).elements().topLeftCorner(low.rows(), low.cols());
    const Eigen::VectorXd scale = low.diagonal().cwiseMax(1e-3).cwiseSqrt();
    return ((high - low).array() / (scale * scale.transpose()).array()).abs().maxCoeff();
  };
  EXPECT_LE(differ({2, 1}, 12, 20), kContactMatrixError);
  EXPECT_LE(differ({2, 2}, 8, 12), kContactMatrixError);
}

}  // namespace
}  // namespace ballpiston
