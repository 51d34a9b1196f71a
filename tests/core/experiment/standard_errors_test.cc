// Which estimates have a standard error, and what stands in its place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/closed_form/ingoing_law.h"
#include "core/ensemble/point_fold.h"
#include "core/experiment/expected_returns.h"
#include "core/geometry/paper.h"
#include "core/model_choice/limit_error.h"
#include "tests/core/geometries.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

PointParameters PairAt(double rho, double delta, std::optional<double> epsilon = {}) {
  return {{kRho, rho}, {kDelta, delta}, {kEpsilon, epsilon}};
}

bool HasRemark(const PointSummary& summary, std::string_view text) {
  return std::ranges::any_of(summary.remarks, [text](const std::string& remark) {
    return remark.find(text) != std::string::npos;
  });
}

// 256 samples at energies where the expected samples of the rarer sign are just below and just
// above
// 50. The measured mean would give the error to half of the seeds.
TEST(StandardErrors, OfMeanSigmaDoesNotDependOnTheSample) {
  for (const double exponent : {0, 1, 3}) {
    for (const double epsilon : {0.07, 0.085}) {
      const double exact = IngoingLaw(epsilon).MeanSigma();
      const bool is_shown = 256 * (1 + exact) / 2 >= 50;
      EXPECT_EQ(is_shown, epsilon < 0.08) << exact;
      for (uint64_t seed = 0; seed < 20; ++seed) {
        const EnsembleSpec spec = SpecOf(&kFirstHit, PaperPoint(0.2, epsilon, exponent),
                                         {.samples = 256}, Model::kBilliard, seed);
        const Estimate sigma = Named("mean_sigma", RunPoint(spec).estimates);
        EXPECT_EQ(sigma.standard_error.has_value(), is_shown) << exponent << " " << seed;
      }
    }
  }
}

TEST(StandardErrors, MeanOfAConstantSignIsExact) {
  const EnsembleSpec spec =
      SpecOf(&kFirstHit, PaperPoint(0.2, 0.3, 0), {.samples = 64}, Model::kBilliard);
  const Estimate sigma = Named("mean_sigma", RunPoint(spec).estimates);
  EXPECT_EQ(sigma.value, -1);
  EXPECT_EQ(sigma.standard_error, 0);
  EXPECT_EQ(sigma.batches, 0u);
}

// A body at rest that is out of reach of the other keeps its energy, so that orbits that do not
// meet have no scatter.
TEST(StandardErrors, OfARelaxationNeedOrbitsThatMeet) {
  for (const PointParameters& point :
       {PairAt(0.6, 0.0194, 0.5), PairAt(kPaperRho, 0.0125, 0), PairAt(0.707, 1e-4, 0)}) {
    EnsembleSpec spec = SpecOf(&kEnergyRelaxation, point, {.samples = 64}, Model::kBilliard);
    const PointSummary summary = RunPoint(spec);
    for (const Estimate& estimate : summary.estimates) EXPECT_FALSE(estimate.standard_error);
    EXPECT_FALSE(summary.curves[0].points.back().standard_error);
    EXPECT_TRUE(HasRemark(summary, "there are no standard errors: ball and piston meet in about"));
    spec.target = {.tolerance = 0.03};
    const auto point_of_job = PointExperiment::Create(spec, 0);
    EXPECT_FALSE(point_of_job->ReachesTolerance(
        *RunBlock(*point_of_job, point_of_job->plan().BlockAt(0, 0))));
    spec.target = {.samples = 64};
    spec.model = Model::kMarkov;  // walks of the jump process always meet
    EXPECT_TRUE(RunPoint(spec).estimates[0].standard_error);
  }
}

// The measured share of orbits that meet: whose energy has left its bin at the end. One in 61 of
// those is back in it. 2000 orbits.
TEST(StandardErrors, ShareThatMeetsIsAboutTheMeasuredOne) {
  for (const auto& [delta, epsilon] : {std::pair{0.1, 0.0},
                                       {0.02, 0.0},
                                       {0.1, 0.5},
                                       {0.2, 0.5},
                                       {0.02, 1e-5},
                                       {0.02, 1e-3},
                                       {0.1, 0.02},
                                       {0.1, 0.4999}}) {
    const PointParameters point = PaperPoint(delta, epsilon);
    const PointSummary summary =
        RunPoint(SpecOf(&kEnergyRelaxation, point, {.samples = 2000}, Model::kBilliard));
    const Histogram& at_end = summary.histograms.back().histogram;
    Histogram start = Histogram::OfBins(at_end.lower, at_end.upper, at_end.counts.size());
    start.Add(epsilon);
    const auto bin =
        static_cast<size_t>(std::ranges::max_element(start.counts) - start.counts.begin());
    const double measured = 1 - static_cast<double>(at_end.counts[bin]) / 2000;
    const double window = *summary.histograms.back().time;
    const double share = ShareThatMeets(PaperGeometry(delta), epsilon, window);
    std::cout << delta << " " << epsilon << ": " << share << ", measured " << measured << "\n";
    EXPECT_GT(share / measured, 0.6) << delta << " " << epsilon;
    EXPECT_LT(share / measured, 1.6) << delta << " " << epsilon;
  }
}

TEST(StandardErrors, OfARelaxationInEquilibriumNeed400Orbits) {
  for (const int64_t orbits : {399, 400}) {
    const PointSummary summary = RunPoint(
        SpecOf(&kEnergyRelaxation, PaperPoint(0.2), {.samples = orbits}, Model::kBilliard));
    EXPECT_EQ(summary.estimates[0].standard_error.has_value(), orbits == 400);
    EXPECT_EQ(HasRemark(summary, "errors need 400 orbits"), orbits < 400);
  }
}

TEST(StandardErrors, RemarkSaysWhyAReturnTimeHasNone) {
  for (const ExperimentKind* experiment : {&kFirstHit, &kConditionalMeanFreeTime}) {
    const auto at = [experiment](double epsilon, int64_t samples) {
      PointParameters point = PaperPoint(0.05, epsilon);
      if (experiment == &kFirstHit) point.Set(kExponent, 1);
      return RunPoint(SpecOf(experiment, point, {.samples = samples}, Model::kBilliard));
    };
    for (const double epsilon : {0.0, 1e-12}) {
      const PointSummary summary = at(epsilon, 1000);
      EXPECT_FALSE(summary.estimates[0].standard_error);
      EXPECT_TRUE(HasRemark(summary, "the mean return time has no standard error"));
    }
    EXPECT_TRUE(HasRemark(at(0, 1000), "the variance of return times is infinite"));
    EXPECT_TRUE(HasRemark(at(1e-12, 1000), "are expected in 1000 samples; an error needs 50"));
    EXPECT_TRUE(at(0.1, 1000).remarks.empty());
    EXPECT_TRUE(at(0, 10).remarks.empty());  // ten samples never have an error
  }
}

TEST(StandardErrors, RemarkSaysHowManySamplesTheyNeed) {
  const auto at = [](const ExperimentKind* experiment, const PointParameters& point, Model model,
                     const Target& target) {
    return RunPoint(SpecOf(experiment, point, target, model));
  };
  for (const int64_t collisions : {499, 500}) {
    const PointSummary summary =
        at(&kEquilibrium, PaperPoint(0.2), Model::kBilliard, {.collisions = collisions});
    EXPECT_EQ(summary.estimates[0].standard_error.has_value(), collisions == 500);
    EXPECT_EQ(HasRemark(summary, "these need 500 collisions"), collisions < 500);
  }
  for (const int64_t collisions : {49 * 32, 50 * 32}) {
    const PointSummary summary =
        at(&kMarkovProperty, PaperPoint(0.2), Model::kMarkov, {.collisions = collisions});
    for (const Estimate& estimate : summary.estimates) {
      EXPECT_EQ(estimate.standard_error.has_value(), collisions == 50 * 32) << estimate.name;
    }
    EXPECT_EQ(HasRemark(summary, "these need 50 orbits of 32 collisions"), collisions < 50 * 32);
  }
  const auto conductivity = [&](const GasShape& shape, int64_t replicas) {
    return at(&kGasEquilibrium, PaperGas(&kGasEquilibrium, 0.2, shape), Model::kMarkov,
              {.samples = replicas});
  };
  // A chain of two is more skewed than a lattice.
  EXPECT_TRUE(HasRemark(conductivity({.columns = 2}, 1000), "this needs 250000 replicas"));
  const GasShape lattice = {.columns = 2, .rows = 1, .is_lattice = true};
  EXPECT_TRUE(HasRemark(conductivity(lattice, 999), "this needs 1000 replicas"));
  const PointSummary enough = conductivity(lattice, 1000);
  EXPECT_FALSE(HasRemark(enough, "the conductivity has no standard error"));
  EXPECT_TRUE(Named("conductivity", enough.estimates).standard_error);
}

// The squares of the times are much more skewed than the times.
TEST(StandardErrors, OfACoefficientOfVariationNeedsAThousandReturns) {
  const auto at = [](int64_t samples) {
    return RunPoint(SpecOf(&kConditionalMeanFreeTime, PaperPoint(0.2, 0.125), {.samples = samples},
                           Model::kBilliard))
        .estimates;
  };
  EXPECT_TRUE(Named("mean_free_time_conditional", at(64)).standard_error);
  EXPECT_FALSE(Named("coefficient_of_variation", at(999)).standard_error);
  EXPECT_TRUE(Named("coefficient_of_variation", at(1000)).standard_error);
}

// A resting ball next to the tip: all returns take the same time but for 1e-13 of it.
TEST(StandardErrors, AreAtLeastTheRoundingOfTheMean) {
  const EnsembleSpec spec = SpecOf(&kConditionalMeanFreeTime, PairAt(kPaperRho, 1e-13, 0.5),
                                   {.samples = 20'000}, Model::kBilliardReference);
  const Estimate time = RunPoint(spec).estimates[0];
  EXPECT_GE(*time.standard_error, 2e-14 * time.value);
  EXPECT_LT(std::fabs(*time.ZScore()), 2);
}

TEST(StandardErrors, ValueIsMissingWhereNothingWasMeasured) {
  for (const ExperimentKind* experiment : {&kEquilibrium, &kConditionalMeanFreeTime, &kFirstHit,
                                           &kEnergyRelaxation, &kMarkovProperty}) {
    PointParameters point = PaperPoint(0.2);
    if (experiment == &kConditionalMeanFreeTime || experiment == &kFirstHit)
      point.Set(kEpsilon, 0.1);
    if (experiment == &kFirstHit) point.Set(kExponent, 1);
    const auto all_escaped =
        PointExperiment::Create(SpecOf(experiment, point, {}, Model::kBilliard), 0);
    const PointSummary summary = all_escaped->Summarize(all_escaped->EmptyResult());
    for (const Estimate& estimate : summary.estimates) {
      EXPECT_TRUE(std::isnan(estimate.value)) << estimate.name;
      EXPECT_FALSE(estimate.standard_error) << estimate.name;
    }
    for (const Curve& curve : summary.curves) EXPECT_TRUE(curve.points.empty()) << curve.name;
  }
}

TEST(StandardErrors, PilotWithoutOneGivesNoBound) {
  const PilotPlace place = PilotPlaceFor(PairAt(kPaperRho, 0.1, 0));
  const auto pilot = PilotExperiment(place);
  const Pilot without = PilotOf(*pilot, pilot->EmptyResult());
  EXPECT_EQ(LimitErrorBound(without, place, PointOf(place)),
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace ballpiston
