// The paper's numbers that tests of several layers use.
#ifndef BALLPISTON_TESTS_SUPPORT_PAPER_H_
#define BALLPISTON_TESTS_SUPPORT_PAPER_H_

namespace ballpiston {

// The radius of the paper's figures, to 15 digits: that of the gas bound delta = 1/5.
inline constexpr double kPaperRho = 0.529561127988977;

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_SUPPORT_PAPER_H_
