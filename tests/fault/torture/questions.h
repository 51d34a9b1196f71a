// The specifications of the torture tests, and their answers by a server that is not killed.
#pragma once

#include "absl/strings/substitute.h"
#include "tests/fault/torture/preamble.h"
#include "tests/support/message_text.h"
#include "tools/flows/paper.h"

namespace ballpiston::torture {

using v1::EnsembleSpec;

inline const std::string kReturns = "experiment: CONDITIONAL_MEAN_FREE_TIME model: BILLIARD ";
inline const std::string kFirstHit = "experiment: FIRST_HIT model: BILLIARD ";

// The message of this text, in which the values replace $0, $1 and so on, at the paper's radius.
template <typename... Values>
EnsembleSpec Question(const std::string& text, const Values&... values) {
  auto spec = FromText<EnsembleSpec>(absl::Substitute(text + " seed: 7", values...));
  spec.mutable_grid()->add_rho(kPaperRho);
  return spec;
}

// In the short form an eighth of the samples.
inline int64_t Samples(int full) { return Size(full / 8, full); }
inline double Tolerance(double full) { return ShareOfFullSize() > 0 ? full : 2 * full; }

// Specifications of every experiment, by several models, with one point and with many, with a
// number of samples and with a tolerance. Each takes 0.02 s to 1 s of one core, or some seconds in
// the long form.
inline std::vector<EnsembleSpec> Questions() {
  const std::string relaxation = "experiment: ENERGY_RELAXATION ";
  return {
      Question("experiment: EQUILIBRIUM model: BILLIARD grid { delta: [0.2, 0.1] }"
               "target { collisions: $0 }",
               Samples(100'000)),
      Question("experiment: EQUILIBRIUM model: CLOSED_FORM grid { delta: [0.2, 0.1, 0.05] }"),
      Question(kReturns + "grid { delta: [0.2, 0.15, 0.1] epsilon: [0.1, 0.2, 0.3, 0.4] }"
                          "target { samples: $0 }",
               Samples(10'000)),
      Question(kReturns + "grid { delta: 0.2 epsilon: 0.25 } target { tolerance: $0 }",
               Tolerance(0.005)),
      Question(kReturns + "grid { delta: 0.2 epsilon: 0.3 } target { samples: $0 }",
               Size(3'000'000, 10'000'000)),  // for checkpoints
      Question(kFirstHit + "grid { delta: 0.2 epsilon: [0.1, 0.4] exponent: 1 }"
                           "target { samples: $0 }",
               Samples(50'000)),
      Question(kFirstHit + "grid { delta: 0.2 epsilon: 0.2 exponent: 1 } target { tolerance: $0 }",
               Tolerance(0.01)),
      Question(relaxation + "model: MARKOV grid { delta: 0.1 } target { samples: $0 }",
               Samples(1'000)),
      Question(relaxation + "model: BILLIARD grid { delta: 0.2 } target { samples: $0 }",
               Samples(500)),
      Question("experiment: MARKOV_PROPERTY model: MARKOV grid { delta: 0.2 }"
               "target { collisions: $0 }",
               Samples(20'000)),
      Question("experiment: GAS_EQUILIBRIUM model: BILLIARD"
               " grid { delta: 0.2 cells: '4' temperature: 1 } target { samples: $0 }",
               Size(1'000, 20'000)),
      Question("experiment: GAS_CONDUCTION model: BILLIARD"
               " grid { delta: 0.2 cells: '4' hot: 1.5 cold: 0.5 } target { samples: $0 }",
               Size(100, 5'000))};
}

// Questions of some seconds of one core, in both forms.
inline std::vector<EnsembleSpec> LargeQuestions() {
  return {Question(kFirstHit + "grid { delta: 0.2 epsilon: [0.1, 0.2, 0.3, 0.4] exponent: 1 }"
                               "target { samples: 300000 }"),
          Question(kReturns + "grid { delta: [0.2, 0.1] epsilon: [0.1, 0.2, 0.3, 0.4] }"
                              "target { samples: 300000 }")};
}

// Many points of similar cost.
inline EnsembleSpec ManyPoints(int points, int64_t samples) {
  EnsembleSpec spec = Question(kReturns + "grid { delta: 0.2 } target { samples: $0 }", samples);
  for (int i = 0; i < points; ++i) spec.mutable_grid()->add_epsilon(0.25 + 0.01 * i / points);
  return spec;
}

// Never ends by itself; saturates the workers with turns of some 50 ms.
inline EnsembleSpec Endless() {
  return Question(kReturns +
                  "grid { delta: 0.2 epsilon: 0.25 }"
                  "target { samples: 1000000000000 }");
}

template <typename Value>
Value OrThrow(absl::StatusOr<Value> value) {
  if (!value.ok()) throw std::runtime_error(value.status().ToString());
  return *std::move(value);
}

// The job at its end.
inline v1::EnsembleJob AwaitEnd(const client::Client& client, const std::string& name) {
  return OrThrow(client.Watch(name, {}, {.give_up_after = absl::FromChrono(kPatience)}));
}

// A point's result, serialized, by its index.
using Answer = std::map<int, std::string>;

inline Answer AnswerOf(const std::vector<v1::PointResult>& points) {
  Answer answer;
  for (v1::PointResult point : points) {
    point.clear_name();  // it has the job's
    answer[point.index()] = point.SerializeAsString();
  }
  return answer;
}

// The answers of a server that is not killed. tests/simulation tests that they count each sample.
inline std::vector<Answer> UndisturbedAnswers(const std::vector<EnsembleSpec>& questions) {
  ConnectedServer server;
  server.Start();
  const client::Client client = server.NewClient();
  std::vector<Answer> answers;
  for (const EnsembleSpec& question : questions) {
    const std::string name = OrThrow(client.Create(question)).name();
    const v1::EnsembleJob job = AwaitEnd(client, name);
    if (job.state() != v1::EnsembleJob::SUCCEEDED) throw std::runtime_error(job.ShortDebugString());
    answers.push_back(AnswerOf(OrThrow(client.Results(name))));
  }
  return answers;
}

}  // namespace ballpiston::torture
