// How much the harness does: little by default, a few seconds each; all of it where
// the environment says BALLPISTON_TORTURE=1 (`make torture`); BALLPISTON_TORTURE=0.1 does a tenth.
#ifndef BALLPISTON_TESTS_FAULT_TORTURE_SIZES_H_
#define BALLPISTON_TESTS_FAULT_TORTURE_SIZES_H_

namespace ballpiston::torture {

// Of the full size; 0 in the short form.
double ShareOfFullSize();

// In the short form `brief`; else the share of `full`, and `brief` at least.
int Size(int brief, int full);

// Whether to hold the server to times, which a busy machine may miss through no fault of its own.
bool HoldsToTimes();

}  // namespace ballpiston::torture

#endif  // BALLPISTON_TESTS_FAULT_TORTURE_SIZES_H_
